"""A short pick-box, a coarse planner, and a world that does as it is told, for tests of the episode."""

import dataclasses

import numpy as np

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningCfg
from coral.contact.cost.stages import Stage, Strategy
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.scene.observation import BodyState, Contact, Observation, Truth
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.mppi.knots import KnotMppiCfg

COARSE = EpisodeCfg(
    poses="ground-truth",
    controller=ControllerCfg(horizon=8, mppi=KnotMppiCfg(samples=6, knots=3)),
    planning=PlanningCfg(threads=1),
)
SLIDE = {
    "format": "coral-contact/1",
    "name": "slide-crate",
    "title": "Slide crate",
    "instruction": "Slide the crate onto the mark.",
    "time_limit_s": 12,
    "objects": [
        {
            "name": "crate",
            "label": "wooden crate",
            "parts": [{"shape": "box", "size": [0.12, 0.1, 0.08]}],
            "mass_kg": 0.3,
            "friction": 0.4,
            "x": 0.02,
            "y": 0.0,
        }
    ],
    "places": {"mark": [0.1, 0.0, 0.04]},
    "success": {
        "hold_s": 0.1,
        "conditions": [{"kind": "at", "object": "crate", "place": "mark", "tolerance_m": 0.03, "axes": "xy"}],
    },
}
"""A task that is none of the shipped ones, and quick."""
COST = """def state_cost(self):
    behind = self.crate_pos + np.array([-0.08, 0.0, -0.01])
    return {"be behind the crate": 6.0 * norm(self.ee_pos - behind),
            "crate at the mark": 20.0 * norm(self.crate_pos[:2] - np.array([0.1, 0.0])),
            "stay upright": 2.0 * (1.0 + quat_axis(self.ee_quat, 2)[2])}
"""
ANSWERS = {
    "physical-parameters": {"crate": {"mass_kg": 0.5, "friction_coeff": 0.5}},
    "cost-function": {"code": COST, "explanation": "Get behind it and push it along x."},
    "contact-regions": {
        "crate": {"regions": [{"center": [-0.06, 0.0, 0.0], "normal": [-1, 0, 0], "approach": "push"}]}
    },
}
"""Answers that slide it."""
DOWN = np.array([0.0, 1.0, 0.0, 0.0])


def short_task(seconds=0.2):
    return load_task("pick-box").model_copy(update={"time_limit_s": seconds})


def make_trial(seconds=0.2, seed=0):
    return sample_trial(short_task(seconds), seed)


def with_planning(cfg, **changes):
    return dataclasses.replace(cfg, **changes)


def stay(state):
    return {"stay": np.square(state.ee_pos).sum(axis=-1)}


def strategy(cost=stay):
    return Strategy("stay", (Stage("stay", cost),))


class ObedientWorld:
    """The hand is where the command says; the box stays, unless `script` says otherwise."""

    name = "obedient"
    control_period_s = 0.02
    simulation = None

    def __init__(self, trial, script=lambda k, box: box, fault=None):
        self._trial, self._script, self._fault, self.commands, self.closed = trial, script, fault, [], False

    def reset(self):
        self._tool, self._k = BodyState(np.array([0.0, 0.0, 0.25]), DOWN), 0
        return self._observe()

    def step(self, target):
        self._k += 1
        if self._fault is not None and self._k >= self._fault[0]:
            raise self._fault[1]
        self.commands.append(target)
        self._tool = BodyState(np.asarray(target.position), np.asarray(target.quaternion))
        return self._observe()

    def truth(self):
        seen = self._observe()
        held = self._script(self._k, seen.objects["box"]) is not seen.objects["box"]
        up = np.array([0.0, 0.0, 2.0])
        contacts = tuple(Contact("box", side, -up, seen.tool.position) for side in ("left", "right")) if held else ()
        objects = {name: self._script(self._k, body) for name, body in seen.objects.items()}
        return Truth(seen.time_s, seen.tool, seen.opening_m, objects, contacts)

    def stop(self):
        self.stopped_after = len(self.commands)

    def close(self):
        self.closed = True

    def _observe(self):
        objects = {name: item.pose for name, item in self._trial.objects.items()}
        return Observation(0.02 * self._k, self._tool, 0.08, np.zeros(6), objects)


class ObedientRobot:
    """The same hand as a robot: nobody knows the truth. Objects are seen where `script` says."""

    name = "robot"
    control_period_s = 0.02

    def __init__(self, trial, script=lambda k, box: box):
        self._inner, self._script, self.calls = ObedientWorld(trial), script, []

    def reset(self):
        self._k = 0
        return self._seen(self._inner.reset())

    def step(self, target):
        self.calls.append("step")
        self._k += 1
        return self._seen(self._inner.step(target))

    def stop(self):
        self.calls.append("stop")

    def close(self):
        self.calls.append("close")

    def _seen(self, now):
        return dataclasses.replace(now, objects={n: self._script(self._k, b) for n, b in now.objects.items()})

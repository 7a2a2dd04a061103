"""How often the outer loop's diagnosis names a fault that was planted, kind by kind, in the hand world.

    python benchmarks/contact_planted.py --episodes 10 --first-seed 1000     # some 15 minutes on one free core

The rules' plan is followed with one fault in its cost, in a condition, in the world or in the believed pose, with few
samples, until the outer loop notices that nothing moves on. Its first diagnosis is right if it is one of those that
describe the fault; FAULTS has them. An episode that succeeds in spite of the fault has no diagnosis to judge and is
counted apart; a fault that is not noticed counts as wrong.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

import numpy as np

from coral.campaign.stats import wilson
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.cost.stages import Strategy
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer, make_strategy
from coral.contact.plan.stage_end import stage_ends
from coral.contact.rules.composition import compose
from coral.contact.scene.geometry import from_rotvec, multiply
from coral.contact.scene.observation import BodyState, HandTarget, Observation
from coral.contact.scene.prior_beliefs import stated_beliefs
from coral.contact.scene.trial import Trial, sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.diagnosis import Diagnosis, diagnose
from coral.contact.thinker.evidence import collect_evidence
from coral.contact.thinker.progress_monitor import OuterCfg, ProgressMonitor
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.thinker.strategist import FixedStrategist, PlanReport
from coral.contact.worlds.hand_world import HandWorld, HandWorldCfg

SAMPLES, HORIZON, REPLAN_STEPS, LIMIT_S = 12, 25, 4, 20.0
PlanEdit = Callable[[PlanAnswer, str], PlanAnswer]


@dataclass(frozen=True)
class Fault:
    """One kind of fault."""

    task: str
    """The task in which it is planted."""
    right: tuple[Diagnosis, ...]
    """The diagnoses that describe it."""
    plan: PlanEdit = lambda plan, name: plan
    """Plants it into the plan."""
    mass: float = 1.0
    """Factor on the true mass; beliefs stay."""
    friction: float = 1.0
    """Factor on the true friction."""
    shift_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Error of the believed positions."""
    turn_rad: float = 0.0
    """Error of the believed headings."""


def first_cost(text: str) -> PlanEdit:
    """Replace the cost of the first stage; `{name}` is the object."""

    def edit(plan: PlanAnswer, name: str) -> PlanAnswer:
        code = f"def state_cost(self):\n    return {{'way': {text.format(name=name)}}}"
        return plan.model_copy(update={"stages": [plan.stages[0].model_copy(update={"code": code}), *plan.stages[1:]]})

    return edit


def also_done(name: str, text: str) -> PlanEdit:
    """Add a comparison that nothing fulfils to the condition that ends a stage; `{name}` is the object."""

    def edit(plan: PlanAnswer, thing: str) -> PlanAnswer:
        return _with_done(plan, name, lambda done: f"{done} and {text.format(name=thing)}")

    return edit


def far_done(plan: PlanAnswer, name: str) -> PlanAnswer:
    """Turn the sign of the distance that ends the reach: it ends where the cost never leads."""
    return _with_done(plan, "reach", lambda done: done.replace("< 0.012", "> 0.4", 1))


def stop_above(plan: PlanAnswer, name: str) -> PlanAnswer:
    """Let the cost of the reach lead 5 cm above where it ends, all else as it is."""
    higher = "off = self.ee_pos - np.array([0.0, 0.0, 0.05]) - "
    stages = [
        stage.model_copy(update={"code": stage.code.replace("off = self.ee_pos - ", higher)})
        if stage.name == "reach"
        else stage
        for stage in plan.stages
    ]
    return plan.model_copy(update={"stages": stages})


def _with_done(plan: PlanAnswer, name: str, change: Callable[[str], str]) -> PlanAnswer:
    stages = [
        stage.model_copy(update={"done": change(stage.done)}) if stage.name == name else stage for stage in plan.stages
    ]
    return plan.model_copy(update={"stages": stages})


def open_fingers(plan: PlanAnswer, name: str) -> PlanAnswer:
    """Leave out the stage that closes the fingers, and hold them open in the next."""
    stages = [stage for stage in plan.stages if stage.name != "close"]
    code = stages[-1].code.replace("20 * self.gripper_target", "200 * abs(self.gripper_target - 0.08)")
    stages[-1] = stages[-1].model_copy(update={"code": code})
    return plan.model_copy(update={"stages": stages})


FAULTS: dict[str, Fault] = {
    "hovers": Fault(
        "pick-box",
        ("settled", "not-reached"),
        first_cost("10.0 * norm(self.ee_pos - self.{name}_pos - np.array([0.0, 0.0, 0.14]))"),
    ),
    "stops 5 cm above": Fault("pick-box", ("settled", "not-reached"), stop_above),
    "wrong sign": Fault("pick-box", ("led-away", "settled"), first_cost("-10.0 * norm(self.ee_pos - self.{name}_pos)")),
    "place off": Fault(
        "pick-box",
        ("settled", "not-reached"),
        first_cost("10.0 * norm(self.ee_pos - self.{name}_pos - np.array([0.14, 0.0, 0.04]))"),
    ),
    "term drowned": Fault(
        "pick-box",
        ("settled", "not-reached"),
        first_cost("norm(self.ee_pos - self.{name}_pos) + 50.0 * norm(self.last_action)"),
    ),
    "beyond the workspace": Fault(
        "pick-box", ("settled", "out-of-reach"), first_cost("10.0 * norm(self.ee_pos - np.array([0.9, 0.0, 0.3]))")
    ),
    "end below the mat": Fault(
        "pick-clutter", ("stage-never-ends",), also_done("lower", "self.{name}_pos[2] < 0.5 * self.{name}_size[2]")
    ),
    "end at one height exactly": Fault(
        "push-force",
        ("stage-never-ends",),
        also_done("reach", "self.ee_pos[2] == self.{name}_size[2] - 0.03"),
    ),
    "waits for the box to rise": Fault(
        "pick-box", ("stage-never-ends",), also_done("reach", "not self.{name}_table_contact")
    ),
    "end with a wrong sign": Fault("pick-box", ("stage-never-ends",), far_done),
    "pressed on the table": Fault(  # a cost that reads a contact there: the planner does not keep the hand off
        "push-force",
        ("blocked",),
        first_cost(
            "10.0 * norm(self.ee_pos - self.{name}_init_pos - np.array([-0.15, 0.0, -0.15])) "
            "- 0.1 * self.table_hand_contact"
        ),
    ),
    "led into the table": Fault(  # the planner keeps the hand from pressing
        "push-force",
        ("settled", "not-reached", "blocked"),
        first_cost("10.0 * norm(self.ee_pos - self.{name}_init_pos - np.array([-0.15, 0.0, -0.15]))"),
    ),
    "pressed on the box": Fault(
        "pick-box",
        ("blocked",),
        first_cost(
            "10.0 * norm(self.ee_pos - self.{name}_init_pos + np.array([0.0, 0.0, 0.1])) + 200.0 * self.gripper_target"
        ),
    ),
    "too heavy": Fault("push-force", ("not-moved", "moved-otherwise"), mass=20.0),
    "fingers held open": Fault("pick-box", ("not-gripped", "slipped"), open_fingers),
    "too heavy to lift": Fault("pick-box", ("slipped", "not-moved", "moved-otherwise"), mass=30.0),
    "pose shifted": Fault("pick-box", ("pose-wrong",), shift_m=(0.0, 0.045, 0.0)),
    "pose turned": Fault("pick-box", ("pose-wrong",), shift_m=(0.011, 0.0, 0.0), turn_rad=0.68),
}
"""The kinds of fault."""


@dataclass(frozen=True)
class PlantedResult:
    """What came of one episode."""

    diagnosis: str
    """The first diagnosis; "" if there is none."""
    succeeded: bool
    """Whether the task succeeded before a diagnosis."""
    time_s: float
    """When the episode ended."""


class PlantedStrategist(FixedStrategist):
    """Follows a plan with a fault until the outer loop notices that nothing moves on, and keeps its diagnosis.

    Args:
        fault: The fault.
    """

    def __init__(self, fault: Fault) -> None:
        self._fault, self._name, self._size = fault, "", np.zeros(3)
        self._monitor: ProgressMonitor
        self.diagnosis = ""

    def begin(self, trial: Trial, first: Observation, world: PlanningWorld) -> Strategy:
        """See `Strategist.begin`."""
        beliefs = stated_beliefs(trial)
        world.believe(beliefs)
        made = compose(scene_facts(trial, first, beliefs))
        sizes = {key: trial.size(key) for key in trial.objects}
        self._name, self._size = next(iter(sizes.items()))
        regions = RegionsAnswer({}) if self._fault.plan is open_fingers else made.regions
        plan = self._fault.plan(made.plan, self._name)
        strategy = make_strategy("planted", plan, regions, world.schema, sizes)
        names, ends = tuple(stage.name for stage in strategy.stages), stage_ends(plan, world.schema)
        self._monitor = ProgressMonitor(OuterCfg(), names, ends)
        return strategy

    def on_plan(self, report: PlanReport) -> Strategy | None:
        """See `Strategist.on_plan`."""
        monitor, name = self._monitor, self._name
        if not self.diagnosis and monitor.update(report):
            surprise_m = monitor.surprise_m.get(name, 0.0)
            evidence = collect_evidence(monitor.steps, monitor.notes, name, self._size, surprise_m, monitor.first_ends)
            self.diagnosis = diagnose(monitor.steps, name, monitor.returns, surprise_m, evidence)
        return None

    def tick(self, run: Episode) -> None:
        """See `Observer.tick`."""

    def stop_requested(self) -> str:
        """See `Observer.stop_requested`: the first diagnosis ends the episode."""
        return "noticed" if self.diagnosis else ""


class MisplacedWorld(HandWorld):
    """The free hand's world, in which objects are seen where they are not.

    Args:
        trial: The trial.
        fault: The fault, with the error of the poses.
    """

    def __init__(self, trial: Trial, fault: Fault) -> None:
        super().__init__(trial, HandWorldCfg())
        self._fault = fault

    def reset(self) -> Observation:
        """See `RobotWorld.reset`."""
        return misplaced(super().reset(), self._fault)

    def step(self, target: HandTarget) -> Observation:
        """See `RobotWorld.step`."""
        return misplaced(super().step(target), self._fault)


def run_planted(fault: Fault, seed: int, latency: str) -> PlantedResult:
    """Follow a plan with a fault until it is noticed, the task succeeds, or the time is over.

    Args:
        fault: The fault.
        seed: Of the trial and of the planner.
        latency: What a plan takes of the world's time: `planning.latency`.
    """
    trial = sample_trial(load_task(fault.task), seed)
    objects = {
        name: replace(
            item,
            physical=replace(
                item.physical,
                mass_kg=item.physical.mass_kg * fault.mass,
                friction=item.physical.friction * fault.friction,
            ),
        )
        for name, item in trial.objects.items()
    }
    short = trial.task.model_copy(update={"time_limit_s": LIMIT_S})
    trial = replace(trial, task=short, objects=objects)
    cfg = EpisodeCfg(poses="ground-truth", replan_steps=REPLAN_STEPS)
    mppi = replace(cfg.controller.mppi, samples=SAMPLES)
    cfg = replace(
        cfg,
        controller=replace(cfg.controller, mppi=mppi, horizon=HORIZON),
        planning=replace(cfg.planning, latency=latency, threads=1),
        record=replace(cfg.record, states=False, report=False),
    )
    strategist = PlantedStrategist(fault)
    with tempfile.TemporaryDirectory() as folder:
        world = MisplacedWorld(trial, fault)
        episode = Episode(trial, world, strategist, cfg, Path(folder) / "run", variant="planted")
        metrics = episode.run([strategist])
    return PlantedResult(strategist.diagnosis, bool(metrics["success"]), float(metrics["sim_time_s"]))


def misplaced(now: Observation, fault: Fault) -> Observation:
    """Return an observation with the fault's error in the poses of the objects."""
    turn = from_rotvec(np.array([0.0, 0.0, fault.turn_rad]))
    objects = {
        name: BodyState(
            body.position + np.asarray(fault.shift_m),
            multiply(turn, body.quaternion),
            body.velocity,
            body.angular_velocity,
        )
        for name, body in now.objects.items()
    }
    return replace(now, objects=objects)


def summary(results: Sequence[tuple[Fault, PlantedResult]]) -> list[str]:
    """Return what the episodes show together, in lines: shares, what always saying the same would score, times."""
    judged = [(fault, found) for fault, found in results if not found.succeeded]
    right = sum(found.diagnosis in fault.right for fault, found in judged)
    low, high = wilson(right, len(judged))
    always = Counter(name for fault, _ in judged for name in fault.right)
    sound = [found for fault, found in judged if not (any(fault.shift_m) or fault.turn_rad)]
    blamed = sum(found.diagnosis == "pose-wrong" for found in sound)
    sound_ends = [found for fault, found in judged if "stage-never-ends" not in fault.right]
    doubted = sum(found.diagnosis == "stage-never-ends" for found in sound_ends)
    times = [found.time_s for _, found in judged if found.diagnosis]
    lines = [
        f"right: {_share(right, len(judged))}, 95 % interval {100 * low:.0f} to {100 * high:.0f} %",
        *(f"always saying {name}: {_share(count, len(judged))}" for name, count in always.most_common(1)),
        f"a pose blamed that was right: {_share(blamed, len(sound))}",
        f"the end of a stage blamed that was right: {_share(doubted, len(sound_ends))}",
    ]
    if times:
        lines.append(f"noticed after {min(times):.1f} to {max(times):.1f} s, median {median(times):.1f} s")
    return lines


def _share(part: int, whole: int) -> str:
    return f"{part} of {whole} ({100 * part / max(whole, 1):.0f} %)"


def main() -> None:
    """Print a row for each kind: right, wrong, not noticed, succeeded in spite of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--episodes", type=int, default=10, help="episodes of each kind")
    parser.add_argument("--first-seed", type=int, default=1000, help="development used seeds below 1000")
    parser.add_argument("--latency", default="fixed:0.02", help="what a plan takes of the world's time; 0: nothing")
    parser.add_argument("--kinds", default=",".join(FAULTS))
    parser.add_argument("--json", action="store_true", help="print one object for each episode")
    args = parser.parse_args()
    rows, found_all = [], list[tuple[Fault, PlantedResult]]()
    for kind in args.kinds.split(","):
        fault, told, good = FAULTS[kind], Counter[str](), 0
        for seed in range(args.first_seed, args.first_seed + args.episodes):
            found = run_planted(fault, seed, args.latency)
            found_all.append((fault, found))
            label = "succeeded" if found.succeeded else found.diagnosis or "not noticed"
            told[label] += 1
            good += found.diagnosis in fault.right
            if args.json:
                print(json.dumps({"kind": kind, "seed": seed, "told": label, "time_s": found.time_s}), flush=True)
        counted = args.episodes - told["succeeded"]
        seen = ", ".join(f"{label} {count}" for label, count in told.most_common())
        rows.append(f"| {kind} | {', '.join(fault.right)} | {good} of {counted} | {seen} |")
    print("| planted | right diagnoses | right | said |\n|---|---|---|---|")
    print("\n".join(rows))
    print("\n".join(summary(found_all)))


if __name__ == "__main__":
    main()

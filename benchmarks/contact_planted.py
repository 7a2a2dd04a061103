"""How often the outer loop's diagnosis names a fault that was planted, kind by kind, in the hand world.

    python benchmarks/contact_planted.py --episodes 10 --first-seed 500      # some 5 minutes on one free core

The rules' plan is followed with one fault in its cost, in a condition, in the world or in the believed pose, with few
samples, until the outer loop notices that nothing moves on. Its first diagnosis is right if it is one of those that
describe the fault; FAULTS has them. An episode that succeeds in spite of the fault has no diagnosis to judge and is
counted apart; a fault that is not noticed counts as wrong.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from coral.contact.control.measured_contacts import touched_by, with_measured_contacts
from coral.contact.control.mppi_controller import Controller, ControllerCfg
from coral.contact.control.planning_world import PlanningCfg, PlanningWorld
from coral.contact.cost.stages import Progress
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer, make_strategy
from coral.contact.rules.composition import compose
from coral.contact.rules.program_edits import tighten
from coral.contact.scene.geometry import from_rotvec, multiply
from coral.contact.scene.judge import Judge
from coral.contact.scene.observation import BodyState, Observation, Transition
from coral.contact.scene.prior_beliefs import stated_beliefs
from coral.contact.scene.trial import Trial, sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.diagnosis import Diagnosis, diagnose
from coral.contact.thinker.evidence import collect_evidence
from coral.contact.thinker.progress_monitor import OuterCfg, ProgressMonitor
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.thinker.strategist import PlanReport
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


def tightened(index: int) -> PlanEdit:
    """Make the condition that ends a stage one that nothing fulfils."""

    def edit(plan: PlanAnswer, name: str) -> PlanAnswer:
        stages = list(plan.stages)
        stages[index] = stages[index].model_copy(update={"done": tighten(stages[index].done)})
        return plan.model_copy(update={"stages": stages})

    return edit


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
    "grasp never done": Fault("pick-box", ("settled",), tightened(0)),
    "push never done": Fault("push-force", ("settled",), tightened(1)),
    "pressed on the table": Fault(
        "push-force",
        ("blocked",),
        first_cost("10.0 * norm(self.ee_pos - self.{name}_init_pos - np.array([-0.15, 0.0, -0.15]))"),
    ),
    "too heavy": Fault("push-force", ("not-moved", "moved-otherwise"), mass=20.0),
    "fingers held open": Fault("pick-box", ("settled", "slipped"), open_fingers),
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


def run_planted(fault: Fault, seed: int) -> PlantedResult:
    """Follow a plan with a fault until it is noticed, the task succeeds, or the time is over.

    Args:
        fault: The fault.
        seed: Of the trial and of the planner.
    """
    believed = sample_trial(load_task(fault.task), seed)
    beliefs = stated_beliefs(believed)
    physical = {
        name: replace(
            item.physical, mass_kg=item.physical.mass_kg * fault.mass, friction=item.physical.friction * fault.friction
        )
        for name, item in believed.objects.items()
    }
    true = replace(
        believed, objects={name: replace(item, physical=physical[name]) for name, item in believed.objects.items()}
    )
    real, judge = HandWorld(true, HandWorldCfg()), Judge(true)
    now = _misplaced(real.reset(), fault)
    planner = PlanningWorld(believed, beliefs, now, PlanningCfg(threads=1), np.random.default_rng([seed, 6]))
    try:
        return _follow(fault, real, judge, planner, believed, now, seed)
    finally:
        planner.close()
        real.close()


def _follow(
    fault: Fault, real: HandWorld, judge: Judge, planner: PlanningWorld, trial: Trial, now: Observation, seed: int
) -> PlantedResult:
    made = compose(scene_facts(trial, now, planner.beliefs[0]))
    name, sizes = next(iter(trial.objects)), {key: trial.size(key) for key in trial.objects}
    regions = RegionsAnswer({}) if fault.plan is open_fingers else made.regions
    strategy = make_strategy("planted", fault.plan(made.plan, name), regions, planner.schema, sizes)
    cfg = ControllerCfg(horizon=HORIZON)
    controller = Controller(
        planner, replace(cfg, mppi=replace(cfg.mppi, samples=SAMPLES)), np.random.default_rng([seed, 1])
    )
    progress, step, taken, opening = Progress(strategy), 0, list[Transition](), now.opening_m
    monitor = ProgressMonitor(OuterCfg(), tuple(stage.name for stage in strategy.stages))
    while now.time_s < LIMIT_S:
        stage = progress.stage
        plan = controller.plan(now, stage, step)
        touched = touched_by(planner, now, opening)
        progress.update(with_measured_contacts(plan.now, now, touched))
        if monitor.update(PlanReport(step, now, plan, stage.name, tuple(taken), touched, plan.now)):
            surprise_m = monitor.surprise_m.get(name, 0.0)
            evidence = collect_evidence(monitor.steps, monitor.notes, name, sizes[name], surprise_m)
            kind = diagnose(monitor.steps, name, monitor.returns, surprise_m, evidence)
            return PlantedResult(kind, False, now.time_s)
        taken = []
        for target in plan.targets[:REPLAN_STEPS]:
            after = _misplaced(real.step(target), fault)
            taken.append(Transition(now, target, after))
            now, step, opening = after, step + 1, target.opening_m
            if judge.success(real.truth()):
                return PlantedResult("", True, now.time_s)
        controller.executed(plan.targets[REPLAN_STEPS - 1], REPLAN_STEPS)
    return PlantedResult("", False, now.time_s)


def _misplaced(now: Observation, fault: Fault) -> Observation:
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


def main() -> None:
    """Print a row for each kind: right, wrong, not noticed, succeeded in spite of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--episodes", type=int, default=10, help="episodes of each kind")
    parser.add_argument("--first-seed", type=int, default=500, help="development used seeds below 500")
    parser.add_argument("--kinds", default=",".join(FAULTS))
    parser.add_argument("--json", action="store_true", help="print one object for each episode")
    args = parser.parse_args()
    rows = []
    right = judged = 0
    for kind in args.kinds.split(","):
        fault, told, good = FAULTS[kind], Counter[str](), 0
        for seed in range(args.first_seed, args.first_seed + args.episodes):
            found = run_planted(fault, seed)
            label = "succeeded" if found.succeeded else found.diagnosis or "not noticed"
            told[label] += 1
            good += found.diagnosis in fault.right
            if args.json:
                print(json.dumps({"kind": kind, "seed": seed, "told": label, "time_s": found.time_s}), flush=True)
        counted = args.episodes - told["succeeded"]
        right, judged = right + good, judged + counted
        seen = ", ".join(f"{label} {count}" for label, count in told.most_common())
        rows.append(f"| {kind} | {', '.join(fault.right)} | {good} of {counted} | {seen} |")
    print("| planted | right diagnoses | right | said |\n|---|---|---|---|")
    print("\n".join(rows))
    print(f"right: {right} of {judged} ({100 * right / max(judged, 1):.0f} %)")


if __name__ == "__main__":
    main()

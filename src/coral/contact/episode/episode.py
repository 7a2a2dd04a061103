"""One contact episode: runs a strategist and the planner on a trial in a world, and writes a run folder."""

from __future__ import annotations

import contextlib
import dataclasses
import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from coral.config import checked, to_mapping, whole_steps
from coral.contact.control.hand_controllers import (
    HandController,
    MakeHandController,
    PlannerLimits,
    hand_controller_maker,
)
from coral.contact.control.hand_plan import HandPlan
from coral.contact.control.measured_contacts import sunk_into, touched_by, with_measured_contacts
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.control.prediction import state_after
from coral.contact.control.reactive import Reactive
from coral.contact.cost.context import Context
from coral.contact.cost.stages import Progress, Strategy, TermWeights
from coral.contact.cost_program.errors import CostError
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.late_plans import Meanwhile, PlanLatency, PlanUnderWay
from coral.contact.episode.metrics import compute_metrics
from coral.contact.episode.recorder import EpisodeRecorder, columns, numbers
from coral.contact.episode.referee import OperatorVerdict, make_referee
from coral.contact.episode.trial_log import conditions_not_held, parameter_fields, start_fields, write_head
from coral.contact.perception.advisor_camera import make_advisor_camera
from coral.contact.perception.guessed_world import GuessedWorld
from coral.contact.perception.symmetry import PoseDifference
from coral.contact.perception.tracked_world import TrackedWorld
from coral.contact.scene.observation import HandTarget, Observation, Transition, Truth
from coral.contact.scene.trial import Trial, prior_beliefs, with_beliefs
from coral.contact.thinker.asker import EpisodeOver
from coral.contact.thinker.strategist import NoStrategy, PlanReport, Strategist
from coral.contact.thinker.think_cfg import NoDecision, decision_budget
from coral.contact.worlds.evaluation_world import EvaluationWorld
from coral.contact.worlds.registry import make_world
from coral.contact.worlds.robot_world import RobotWorld, WorldError, in_real_time
from coral.errors import InputError, RunError
from coral.run_files import RunFiles
from coral.run_loop import Observer, run_to_end, stoppable, timing_of
from coral.runs import RunWriter

PATIENCE_PLANS = 25
"""The episode ends after this many successive plans without a valid rollout."""


class Episode:
    """Couples an evaluation world with the planner and records what happens.

    The world is the name of an evaluation world, or one of your own, such as a robot; the controller a name, or the
    function that makes it. `variant` and `advisor` are for the record. `operator_verdict` asks the operator, who may
    judge the episode.

    Raises:
        InputError: A value is out of range, a name is unknown, or the folder is not empty.
        RunError: A package that the world needs is not installed.
    """

    def __init__(
        self,
        trial: Trial,
        world: str | RobotWorld,
        strategist: Strategist,
        cfg: EpisodeCfg,
        folder: Path,
        *,
        variant: str,
        advisor: str = "none",
        controller: str | MakeHandController = "mppi",
        operator_verdict: OperatorVerdict | None = None,
    ) -> None:
        self._make_controller = hand_controller_maker(controller)
        cfg = checked(cfg, "--cfg")
        think = dataclasses.replace(cfg.think, budget=decision_budget(cfg.think.budget, advisor))
        cfg = dataclasses.replace(cfg, think=think)
        self.trial, self.strategist, self.cfg = trial, strategist, cfg
        self.variant, self.advisor = variant, advisor
        self.time_limit_s = trial.task.time_limit_s
        self.step, self.t, self.end_reason, self.detail = 0, 0.0, "", ""
        self.plan_ms: list[float] = []
        self.interventions = 0
        self.weights = TermWeights()
        """Factors on the terms of the costs; a live page sets them."""
        self.latest_plan: HandPlan | None = None
        whole_steps(cfg.planning.step_s, cfg.planning.physics_dt_s, "--cfg", "planning.physics_dt_s")
        self.world: RobotWorld = make_world(world, trial, cfg.planning.step_s) if isinstance(world, str) else world
        if abs(self.world.control_period_s - cfg.planning.step_s) > 1e-9:
            expected = f"{self.world.control_period_s:g} s, the control period of the world {self.world.name!r}"
            raise InputError("--cfg", "planning.step_s", cfg.planning.step_s, expected)
        self.referee = make_referee(cfg.judged_by, self.world, trial, operator_verdict)
        self.look, self.look_down = (
            make_advisor_camera(self.world, trial, cfg.tracked, cfg.sight, np.random.default_rng(key), above)
            for key, above in (([trial.seed, 5], False), ([trial.seed, 5, 1], True))
        )
        self.tracked: TrackedWorld | None = None
        self.guessed: GuessedWorld | None = None
        if not isinstance(self.world, EvaluationWorld):
            if strategist.guesses_poses:
                raise InputError("--variant", "", variant, "one whose poses are measured: no picture can be made here")
        elif strategist.guesses_poses:
            self.world = self.guessed = GuessedWorld(self.world, trial)
        elif cfg.poses == "tracked":
            rng = np.random.default_rng([trial.seed, 4])
            self.world = self.tracked = TrackedWorld(self.world, trial, cfg.tracked, rng)
        self.latency = PlanLatency(cfg.planning.latency, cfg.planning.step_s, cfg.replan_steps, cfg.controller.horizon)
        self._meanwhile: Meanwhile | None = None
        if in_real_time(self.world):
            if not self.latency.charged:
                expected = f"measured or fixed:SECONDS: the world {self.world.name!r} does not wait for a plan"
                raise InputError("--cfg", "planning.latency", repr(cfg.planning.latency), expected)
            self._meanwhile = Meanwhile(self._go_on_once)
        # All checks that can refuse the input come before the folder is created.
        objects = [item.name for item in trial.task.objects]
        self.writer = RunWriter(folder, columns(objects))
        self.recorder = EpisodeRecorder(self.writer, cfg.record, objects)
        self.listeners: list[Callable[[Mapping[str, Any]], None]] = []
        self._under_way: PlanUnderWay | None = None
        self._ahead, self._followed = 0, 0
        self._predicted: Observation
        self._without_plan = 0
        self._taken: list[Transition] = []
        self._touched: dict[str, tuple[str, ...]] = {}
        self._present: Context | None = None
        self._wall = 0.0
        self._late: InputError | RunError | None = None
        self._before_s, self._thought_s = 0.0, 0.0
        self._begun = self._thinking = False
        self.now: Observation
        self.planner: PlanningWorld
        self.controller: HandController
        self.reactive: Reactive
        self.progress: Progress
        self._since: Observation

    @property
    def stage(self) -> str:
        """Return the name of the active stage."""
        return self.progress.stage.name

    def planner_limits(self) -> PlannerLimits:
        """Return what the planner can do now: a measured latency varies."""
        cfg, step_s = self.cfg, self.cfg.planning.step_s
        replan_s = self.latency.expected_steps() * step_s
        force_n, arm = cfg.reactive.force_limit_n, self.world.name != "hand"
        return PlannerLimits(cfg.controller, step_s, replan_s, self.latency.plan_s, force_n, arm)

    def run(self, observers: Sequence[Observer[Episode]] = ()) -> dict[str, Any]:
        """Run to the end and return metrics and timing together.

        Raises:
            InputError, RunError: The strategist failed at the end; the run folder is complete nevertheless.
        """
        started = time.perf_counter()
        try:
            self._run(observers)
        finally:
            self._end()
            self._wall = time.perf_counter() - started
        made = self._finish()
        if self._late is not None:
            raise self._late
        return made

    def _run(self, observers: Sequence[Observer[Episode]]) -> None:
        with stoppable(self):
            try:
                self._begin()
            except WorldError as fault:
                self.end_reason, self.detail = fault.code, str(fault)
            except NoStrategy as none:
                self.end_reason, self.detail = "no-strategy", str(none)
            except NoDecision as none:
                self.end_reason, self.detail = none.end_reason, str(none)
            except CostError as error:  # its process died although the programs had been checked
                self.end_reason, self.detail = "cost-error", str(error)
            run_to_end(self, observers)

    def advance(self) -> None:
        """Plan once, and execute the next steps."""
        self._tell_interventions()
        plan = self._plan()
        if plan is not None:
            self._take(plan, self.cfg.replan_steps)

    def _tell_interventions(self) -> None:
        """Record what a person has changed in the cost: the result is not the strategy's alone."""
        for stage, term, factor in self.weights.news():
            self.interventions += 1
            self.emit("weight", stage=stage, term=term, factor=round(factor, 4), by="operator")

    def _take(self, plan: HandPlan, most: int) -> None:
        """Execute a plan's first steps; if planning takes time, those of the plan before until this one is ready."""
        if self.latency.charged:
            self._await(plan)
            return
        taken, under_way = 0, PlanUnderWay(plan)
        for _ in range(min(self.cfg.replan_steps, most, len(plan.targets))):
            if not self._act(under_way):
                break
            taken += 1
            if self.end_reason:
                break
        self._followed = taken

    def _await(self, plan: HandPlan) -> None:
        """Follow the plan under way until `plan` is ready, and hand over to it."""
        if self._meanwhile is None:
            taken, steps = 0, max(self._ahead, self.latency.taken_steps(1e-3 * self.plan_ms[-1]))
        else:
            taken = self._meanwhile.steps
            self.latency.taken_steps(taken * self.cfg.planning.step_s)
            steps = max(self._ahead, taken)
        for _ in range(steps - taken):
            if not self._go_on_once():
                return
        self._under_way = PlanUnderWay.beginning(plan, steps - self._ahead, self._predicted, self.now)

    def _go_on_once(self) -> bool:
        """Execute one control step of the plan under way; return False if the episode ended."""
        going = self._hold_still() if self._under_way is None else self._act(self._under_way)
        return going and not self.end_reason

    def _plan_start(self) -> tuple[Observation, int, HandTarget, int]:
        """Return state, step, target of the hand and executed steps where the plan begins: now, or when it is ready."""
        if not self.latency.charged:
            followed, self._followed = self._followed, 0
            return self.now, self.step, self._still, followed
        self._ahead = self.latency.expected_steps()
        followed = 0
        if self._under_way is None:
            coming = (self._still,) * self._ahead
        else:
            coming = self._under_way.coming(self._ahead)
            followed = self._under_way.next + self._ahead
        self._predicted = state_after(self.planner, self.now, coming, self.step)
        return self._predicted, self.step + self._ahead, coming[-1], followed

    def emit(self, event: str, **fields: Any) -> None:
        """Append an event at the present step and notify listeners."""
        self.writer.event(self.step, self.t, event, **fields)
        for listener in self.listeners:
            listener({"event": event, "t": self.t, **fields})

    @property
    def clock_s(self) -> float:
        """Return the simulated time (s), including latencies before the first plan."""
        return self._before_s + self.t

    def go_on(self, seconds: float) -> bool:
        """Continue the episode while an advisor answers; return False if it ended meanwhile.

        Before the first strategy nothing moves, and the time is only counted.
        """
        if not self._begun:
            self._before_s += seconds
            self.emit("thinking", seconds=round(seconds, 6), meanwhile="before")
            return True
        if self.end_reason:
            return True
        began, going = self.t, True
        self._thinking = True
        while self.t < began + seconds - 1e-9 and not self.end_reason:
            try:
                plan = self._replan() if going else None
            except CostError:  # a repair of this cost is under way
                plan, going = None, False
            if plan is not None:
                self._take(plan, math.ceil((began + seconds - self.t) / self.cfg.planning.step_s - 1e-6))
            elif not self.end_reason:
                self._hold_still()
        self._thinking = False
        self._thought_s += self.t - began
        self.emit("thinking", seconds=round(self.t - began, 6), meanwhile="the last plan" if going else "holding still")
        return not self.end_reason

    def _plan(self) -> HandPlan | None:
        """Plan, and pass the plan to the strategist; None if there is nothing to execute."""
        stage = self.progress.stage
        try:
            plan = self._replan()
        except CostError as error:
            failed = error
            other = self._ask_strategist(lambda: self.strategist.on_cost_error(failed, stage.name, self.now))
            if other is not None:
                self._follow(other)
            elif not self.end_reason:
                self._cost_error(error, stage.name)
            return None
        if plan is None:
            return None
        taken, self._taken = tuple(self._taken), []
        step = self.step
        try:
            report = PlanReport(
                now=self.now,
                plan=plan,
                stage=stage.name,
                taken=taken,
                touched=self._touched,
                sunk_m=sunk_into(self.planner, self.now),
                next_state=self._next_state(plan),
                present=self._present,
            )
            other = self._ask_strategist(lambda: self.strategist.on_plan(report))
        except CostError as error:
            self._cost_error(error, stage.name)
            return None
        if other is not None:
            self._follow(other)
        return plan if self.step == step and not self.end_reason else None

    def _next_state(self, plan: HandPlan) -> Context | None:
        """Return the state predicted after the next control step; None without a prediction."""
        if not self.latency.charged:
            return plan.now
        under_way = self._under_way
        return under_way.plan.now if under_way is not None and under_way.next == 0 else None

    def _ask_strategist(self, ask: Callable[[], Strategy | None]) -> Strategy | None:
        """Return the strategist's reply; None if the episode ended meanwhile or for lack of a decision."""
        try:
            return ask()
        except EpisodeOver:
            return None
        except NoDecision as none:
            self.end_reason, self.detail = none.end_reason, str(none)
            return None

    def _replan(self) -> HandPlan | None:
        """Plan in the active stage; None if the episode ends for lack of a plan.

        Raises:
            CostError: The stage's cost could not be evaluated.
        """
        stage = self.progress.stage
        begun = time.perf_counter()
        start, step, target, followed = self._plan_start()
        with contextlib.nullcontext() if self._meanwhile is None else self._meanwhile:
            plan = self.controller.plan(start, self.weights.weighed(stage), step, self._since, target, followed)
        if self.end_reason:  # the world ended the episode meanwhile
            return None
        opening_m = self._still.opening_m
        self._touched = touched_by(self.planner, self.now, opening_m)
        present = plan.now
        if present is None or self.latency.charged:
            present = self.planner.present(self.now, self.step, opening_m, self._since)
        self._present = with_measured_contacts(present, self.now, self._touched)
        changed = self.progress.update(self._present)
        self.plan_ms.append(1e3 * (time.perf_counter() - begun))
        self.latest_plan = plan
        self.emit(
            "plan",
            stage=stage.name,
            cost=_number(plan.cost),
            ess=round(plan.effective_samples, 2),
            diverged=plan.diverged,
            ok=plan.valid,
            terms={name: _number(value) for name, value in plan.terms.items()},
            aim=numbers(plan.targets[-1].position, 4),
            touched=sorted({name for names in self._touched.values() for name in names}),
            **({"ahead_s": round(self._ahead * self.cfg.planning.step_s, 6)} if self.latency.charged else {}),
        )
        if not all(
            np.isfinite([*target.position, *target.quaternion, target.opening_m]).all()
            for target in plan.targets[: self.cfg.replan_steps]
        ):
            self.end_reason, self.detail = "no-plan", "the plan contains a value that is not finite"
            return None
        self._without_plan = 0 if plan.valid else self._without_plan + 1
        if self._without_plan >= PATIENCE_PLANS:
            self.end_reason = "no-plan"
            self.detail = f"{self._without_plan} plans in a row had no valid rollout"
            return None
        if changed:
            self._since = self.now
            self.emit("stage", before=stage.name, stage=self.stage, index=self.progress.index)
        return plan

    def _cost_error(self, error: CostError, stage: str) -> None:
        self.end_reason, self.detail = "cost-error", f"stage {stage!r}: {error}"

    def _act(self, under_way: PlanUnderWay) -> bool:
        """Execute the next control step of a plan; return False if the world failed."""
        (planned,), k = under_way.coming(1), min(under_way.next, len(under_way.plan.targets) - 1)
        target = self._still = planned
        if self.tracked is not None:
            target = self.tracked.retreat(target, self.now)
        if not self._step(target):
            return False
        under_way.next += 1
        if target is planned:
            under_way.compare(k, self.now, self.reactive)
        else:
            self.reactive.reset()  # the plan predicted another outcome of this step
        return True

    def _hold_still(self) -> bool:
        """Execute one control step towards the last target of the hand; return False if the world failed."""
        self.reactive.reset()
        self._under_way = None
        return self._step(self._still)

    def _step(self, target: HandTarget) -> bool:
        """Execute one control step; return False if the world failed."""
        before = self.now
        command = self.reactive.command(target, before)
        try:
            self.now = self.world.step(command)
            truth = self.referee.judged_state(self.now)
        except WorldError as fault:
            self.end_reason, self.detail = fault.code, str(fault)
            return False
        self._taken.append(Transition(before, command, self.now))
        self.step += 1
        self.t = self.now.time_s
        self._emit_track_changes()
        seen = self._pose_errors(truth)
        self.recorder.record(self.step, self.world, self.now, truth, command, self.progress.index, seen)
        time_left = self._thinking or self.t - self._thought_s < self.time_limit_s - 1e-9
        self.end_reason = self.referee.end_reason(truth, time_left)
        if self.end_reason == "timeout":
            self.detail = conditions_not_held(self.trial, self.referee.holding, truth)
        return True

    def _begin(self) -> None:
        cfg = self.cfg
        self._emit_start()
        self.strategist.attach(self, self.emit, self.planner_limits, self.look, self.look_down)
        self.now = self.world.reset()
        self.t = self.now.time_s
        if self.guessed is not None:
            self.now = self.guessed.settle(self.strategist.guess_poses(self.trial, self.now), self.now)
        self._emit_track_changes()
        self.planner = PlanningWorld(self.trial.known, prior_beliefs(self.trial), self.now, cfg.planning)
        rng = np.random.default_rng([self.trial.seed, 1])
        self.controller = self._make_controller(self.planner, cfg.controller, rng)
        self.controller.reset(self.now)
        low, high = np.asarray(cfg.controller.workspace_low_m), np.asarray(cfg.controller.workspace_high_m)
        self.reactive = Reactive(cfg.reactive, cfg.planning.step_s, low, high)
        first = self._still = HandTarget(
            self.now.tool.position, self.now.tool.quaternion, self.now.opening_m, cfg.planning.hand.stiffness_n_m
        )
        truth = self.referee.judged_state(self.now)
        self.recorder.record(0, self.world, self.now, truth, first, 0, self._pose_errors(truth))
        self._follow(self.strategist.begin(as_perceived(self.trial, self.now), self.now, self.planner))
        self._begun = True

    def _emit_start(self) -> None:
        about = {"world": self.world.name, "variant": self.variant, "advisor": self.advisor, "seed": self.trial.seed}
        write_head(self.writer, self.trial, about, to_mapping(self.cfg))
        poses: str = self.cfg.poses if self.guessed is None else "guessed"
        if not isinstance(self.world, EvaluationWorld):
            poses = "measured"
        judged = {} if self.referee.name == "truth" else {"judged_by": self.referee.name}
        tracker = {} if self.tracked is None else {"tracker": self.tracked.tracker}
        self.emit("start", **start_fields(self.trial, **about, poses=poses, **tracker, **judged))

    def _emit_track_changes(self) -> None:
        for fields in self.tracked.news() if self.tracked is not None else ():
            self.emit("track", **fields)

    def _pose_errors(self, truth: Truth) -> Mapping[str, PoseDifference] | None:
        """Compute the error of the tracked poses: for the record, never for a decision."""
        seen = self.tracked or self.guessed
        return None if seen is None or not truth.contacts_known else seen.compare(self.now, truth)

    def _follow(self, strategy: Strategy) -> None:
        self.progress, self._since = Progress(strategy), self.now
        self.reactive.reset()
        self.emit(
            "strategy",
            name=strategy.name,
            stages=[stage.name for stage in strategy.stages],
            beliefs=[{name: parameter_fields(held) for name, held in one.items()} for one in self.planner.beliefs],
        )
        self.emit("stage", before=None, stage=self.stage, index=self.progress.index)

    def _end(self) -> None:
        self.world.stop()  # before anything that takes time: a robot must not wait for its record
        try:
            self.strategist.on_end("intervened" if self.interventions else self.end_reason or "failed")
        except (InputError, RunError) as error:
            # Like a memory that cannot be written, this is raised after the record is complete.
            self._late = error
        counts = dataclasses.asdict(self.strategist.counts)
        self.recorder.state(self.step, self.t, self.world, last=True)
        self.recorder.close(self.step)
        self.emit("end", reason=self.end_reason or "failed", detail=self.detail, **counts)
        self.writer.close()
        self.world.close()
        if hasattr(self, "planner"):
            self.planner.close()

    def _finish(self) -> dict[str, Any]:
        timing = timing_of(self._wall, self.t, plan_ms=self.plan_ms)
        metrics = compute_metrics(self.writer.folder)
        self.writer.json(RunFiles.METRICS, metrics)
        self.writer.json(RunFiles.TIMING, timing)
        return {**metrics, **timing}


def as_perceived(trial: Trial, now: Observation) -> Trial:
    """Return the trial as the robot perceives it: estimated poses, prior masses and frictions."""
    held = with_beliefs(trial.known, prior_beliefs(trial))
    objects = {name: dataclasses.replace(item, pose=now.objects[name]) for name, item in held.objects.items()}
    return dataclasses.replace(held, objects=objects)


def _number(value: float) -> float | None:
    """Return a number for JSON; None if it is not finite."""
    return round(value, 5) if np.isfinite(value) else None

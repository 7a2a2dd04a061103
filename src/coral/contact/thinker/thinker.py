"""CoRAL's outer loop: beliefs, a plan from memory or from the advisor, regions, repair when stuck (Fig. 2)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from coral.advisor.question import Picture
from coral.contact.control.hand_controllers import PlannerLimits
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.cost.stages import Strategy
from coral.contact.cost_program import CostError
from coral.contact.cost_program.worker import CostWorker
from coral.contact.memory.goal_match import scene_numbers
from coral.contact.memory.memory import Experience, Match, Memory, RememberedPlan
from coral.contact.perception.advisor_camera import Look, to_picture
from coral.contact.perception.scene_labels import ABOVE, PictureLabels, label_picture
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer, make_strategy
from coral.contact.plan.stage_end import stage_ends
from coral.contact.scene.observation import BodyState, Observation, Transition
from coral.contact.scene.trial import PhysicalParameters, Trial
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.diagnosis import TEXTS, Diagnosis, diagnose
from coral.contact.thinker.evidence import collect_evidence
from coral.contact.thinker.pose_question import ask_poses
from coral.contact.thinker.progress_monitor import ProgressMonitor
from coral.contact.thinker.questions import Questions
from coral.contact.thinker.recall import Recall
from coral.contact.thinker.repair_prompt import recent, repair_values
from coral.contact.thinker.strategist import NoStrategy, PlanReport, StrategistCounts
from coral.contact.thinker.think_cfg import ThinkCfg
from coral.contact.thinker.thinking_clock import Thinking
from coral.contact.thinker.world_model_correction import CorrectionSchedule, correct_beliefs
from coral.contact.world_model.history_replay import most_informative_object
from coral.errors import RunError

TELL_NOTHING: frozenset[Diagnosis] = frozenset({"led-away", "out-of-reach", "pose-wrong", "not-reached", "passes-over"})
"""Diagnoses whose history says nothing about mass and friction: nothing was pushed, or not where it was believed."""


class Thinker:
    """The paper's strategist, which decides by asking an advisor.

    The inner loop minimises a cost over controls for given stages, masses and frictions; the outer loop chooses these.
    It begins with a remembered plan that fits, or asks for one. When the cost stops falling, it fits masses and
    frictions to the history and asks for another plan.

    `worker`, the confined process, runs all cost programs: answers and memories may come from anyone. It is closed at
    the end. `provenance` (world, seed, variant, advisor) is stored with an experience. `given` beliefs take
    precedence over the advisor's estimates at the start.
    """

    def __init__(
        self,
        asker: Asker,
        cfg: ThinkCfg,
        rng: np.random.Generator,
        worker: CostWorker,
        memory: Memory | None = None,
        provenance: Mapping[str, Any] | None = None,
        given: Mapping[str, PhysicalParameters] | None = None,
    ) -> None:
        self.asker, self.cfg, self.memory = asker, cfg, memory
        self._rng, self._worker = rng, worker
        self._provenance = dict(provenance or {})
        self._emit: Callable[..., None]
        self._given = dict(given or {})
        self._correction_schedule = CorrectionSchedule(cfg.correct_every_s if cfg.refine and not cfg.unified else 0.0)
        self._now: Observation
        self._repairs = 0
        self._match: Match | None = None
        self._numbers: dict[str, float] = {}
        """Measurements of the scene as the first plan found it."""
        self._repairs_left: list[RememberedPlan] = []
        self._followed: list[RememberedPlan] = []
        self._asked = False
        self._history: list[Transition] = []
        self._corrected: list[str] = []
        self._evidence: list[str] = []
        self._trial: Trial
        self._world: PlanningWorld
        self._plan: PlanAnswer
        self._regions = RegionsAnswer({})
        self._questions: Questions
        self._monitor: ProgressMonitor
        self._camera: Look
        self._limits: Callable[[], PlannerLimits]

    @property
    def counts(self) -> StrategistCounts:
        """See `Strategist.counts`."""
        return StrategistCounts(self.asker.calls, self._repairs, self._match is not None)

    @property
    def _diagnosed_by_model(self) -> bool:
        """Return whether the advisor is to find out what went wrong, as the paper's does; the record still names it."""
        return self.cfg.prompt == "paper"

    @property
    def guesses_poses(self) -> bool:
        """See `Strategist.guesses_poses`."""
        return not self.cfg.tracking

    def attach(
        self,
        thinking: Thinking,
        emit: Callable[..., None],
        limits: Callable[[], PlannerLimits],
        look: Look,
        above: Look,
    ) -> None:
        """See `Strategist.attach`."""

        def take(labels: PictureLabels | None) -> tuple[Picture, ...]:
            frame = look()
            if frame is None:
                return ()
            if labels is None:
                return (to_picture(frame),)
            top = above()
            from_above = () if top is None else (label_picture(top, labels, "above", ABOVE),)
            return (label_picture(frame, labels), *from_above)

        self._emit = self.asker.emit = emit
        self._limits, self._camera = limits, look
        self.asker.clock.thinking, self.asker.pictures = thinking, take

    def guess_poses(self, trial: Trial, first: Observation) -> dict[str, BodyState]:
        """See `Strategist.guess_poses`."""
        frame = self._camera()
        if frame is None:
            raise RunError("poses cannot be guessed in a world without pictures")
        return ask_poses(self.asker, trial, first, frame, self._emit, self.cfg.fallback)

    def begin(self, trial: Trial, first: Observation, world: PlanningWorld) -> Strategy:
        """Perceive, recall or ask, verify, and make the strategy."""
        self._trial, self._world = trial, world
        self._questions = Questions(self.asker, trial, world, self.cfg, self._worker.load, self._emit, self._limits)
        self._questions.update_facts(first, believed=False)
        if self.cfg.unified:
            self._plan, self._regions = self._questions.ask_everything(first) or self._questions.no_plan()
            strategy = self._strategy("asked")
        else:
            strategy = self._recall_or_ask(first)
        self._monitor = self._new_monitor()
        return strategy

    def _recall_or_ask(self, first: Observation) -> Strategy:
        questions = self._questions
        questions.ask_parameters(self._given)
        questions.update_facts(first)
        self._numbers = scene_numbers(questions.facts)
        strategy = self._recall(first)
        if strategy is not None:
            return strategy
        asked = questions.ask_plan(first)
        self._plan = questions.no_plan() if asked is None else asked
        self._regions = questions.ask_regions(self._plan)
        return self._strategy("asked")

    def on_plan(self, report: PlanReport) -> Strategy | None:
        """Ask again if there is no progress."""
        self._history += report.taken
        self._now = report.now
        if self._monitor.update(report) and self.cfg.refine and self._repairs < self.cfg.outer.refinements:
            return self._refine(report)
        self._correct_if_due()
        return None

    def on_cost_error(self, error: CostError, stage: str, now: Observation) -> Strategy | None:
        """Ask for the repair of a cost that failed in use, at most as often as the outer loop may replan."""
        self._emit("cost_error", stage=stage, code=error.code, reason=str(error))
        if not self.cfg.refine or self._repairs >= self.cfg.outer.refinements:
            return None
        self._repairs += 1
        self._questions.diagnoses.append("cost-error")
        self._questions.update_facts(now)
        try:
            self._replan(now, self._questions.no_plan, f"in stage {stage!r}, {error}")
        except NoStrategy:
            return None
        return self._repaired_strategy()

    def on_end(self, reason: str) -> None:
        """Store a successful plan; record whether a remembered one helped."""
        try:
            self._remember_outcome(reason == "success")
        finally:
            self._worker.close()
            self.asker.close()

    def _remember_outcome(self, success: bool) -> None:
        self._correct_if_due(last=True)
        if self.memory is None:
            return
        followed = self._match is not None and not self._asked
        if self._match is not None:
            self.memory.used(self._match.stored.id, success and followed)
        # A plan without regions cannot guide a later episode; a fallback's decisions are not the advisor's experience.
        if success and not followed and self.cfg.regions and not self._questions.stood_in:
            number = self.memory.add(self._experience())
            self._emit("remembered", id=number, file=Path(self.memory.where).name)

    def _recall(self, first: Observation) -> Strategy | None:
        if self.memory is None:
            return None
        chosen = Recall(self._questions, self._trial, self._world, self.cfg).choose(self.memory, first, self._emit)
        if chosen is None:
            return None
        begun, *self._repairs_left = chosen.steps
        self._match, self._plan, self._regions = chosen.match, begun.plan, begun.regions
        return self._strategy(f"remembered {chosen.match.stored.id}")

    def _strategy(self, name: str) -> Strategy:
        regions = self._regions if self.cfg.regions else None
        step = RememberedPlan(plan=self._plan, regions=self._regions)
        if not self._followed or self._followed[-1] != step:
            self._followed.append(step)
        candidates = [] if regions is None else self._questions.touchable_candidates(regions, self._plan)
        schema, sizes = self._world.schema, self._questions.sizes
        return make_strategy(name, self._plan, regions, schema, sizes, self._worker.load, candidates)

    def _new_monitor(self) -> ProgressMonitor:
        ends = stage_ends(self._plan, self._world.schema, self._worker.load)
        return ProgressMonitor(self.cfg.outer, tuple(self._plan.names), ends)

    def _repaired_strategy(self) -> Strategy:
        try:
            strategy = self._strategy(f"repair {self._repairs}")
        except CostError as error:
            raise RunError(f"the repaired plan cannot be made: {error}") from None
        self._monitor = self._new_monitor()
        return strategy

    def _repair_remembered(self, now: Observation) -> bool:
        """Take the remembered repair of the remembered plan, if it passes the checks of any answer."""
        if not self._repairs_left:
            return False
        step, *rest = self._repairs_left
        refusal = self._questions.check_plan(step.plan, now) or (
            self._questions.check_regions(step.regions, step.plan) if self.cfg.regions else None
        )
        self._repairs_left = [] if refusal else rest
        if refusal is not None:
            self._emit("recall_repair", refused=refusal.reason)
            return False
        self._emit("recall_repair", refused="", explanation=step.plan.explanation, decided="repair", source="memory")
        self._plan, self._regions = step.plan, step.regions
        return True

    def _replan(self, now: Observation, otherwise: Callable[[], PlanAnswer], error: str = "") -> None:
        if self._repair_remembered(now):
            return
        history = repair_values(
            self._plan,
            self._regions if self.cfg.regions else None,
            self._monitor,
            most_informative_object(self._monitor.steps) or next(iter(self._questions.sizes)),
            self._questions.diagnoses,
            evidence=self._evidence,
            corrected=self._corrected,
            advice=self._questions.advice,
            error=error,
            bare=self._diagnosed_by_model,
        )
        if self.cfg.unified:
            self._plan, self._regions = self._questions.ask_everything(now, history) or (otherwise(), self._regions)
            return
        before = self._plan
        self._plan = self._questions.ask_plan(now, history) or otherwise()
        if self._plan is not before:  # an unchanged plan keeps its regions
            self._asked = True
            self._repairs_left = []
            self._regions = self._questions.ask_regions(self._plan)

    def _refine(self, report: PlanReport) -> Strategy | None:
        """Diagnose, correct the world model, ask for a better plan."""
        monitor, now = self._monitor, report.now
        name = most_informative_object(monitor.steps) or next(iter(self._questions.sizes))
        surprise_m = monitor.surprise_m.get(name, 0.0)
        found = None
        if monitor.steps:
            size = self._questions.sizes[name]
            found = collect_evidence(monitor.steps, monitor.notes, name, size, monitor.first_ends)
        kind = diagnose(monitor.steps, name, monitor.returns, surprise_m, found)
        self._evidence = [] if found is None else found.sentences()
        self._repairs += 1
        self._emit(
            "stuck",
            attempts=monitor.attempts,
            stage=report.stage,
            object=name,
            diagnosis=kind,
            text=TEXTS[kind],
            evidence=self._evidence,
            cost=round(report.plan.cost, 4),
            history=recent(monitor.steps, monitor.costs, name),
        )
        tells = self._diagnosed_by_model or kind not in TELL_NOTHING
        corrected = tells and not self.cfg.unified and self._correct(name, now)
        now = self._questions.present(now)  # a later one if the advisor took time to answer
        self._questions.update_facts(now)
        if corrected and kind == "moved-otherwise" and not self._diagnosed_by_model:
            # The plan was right, the world model was not: continue the stage with the corrected model.
            self._monitor = self._new_monitor()
            return None
        self._questions.diagnoses.append(kind)
        self._replan(now, lambda: self._questions.keep_plan(self._plan))
        return self._repaired_strategy()

    def _correct(self, name: str, now: Observation) -> bool:
        monitor, facts = self._monitor, self._questions.facts
        steps, rows = tuple(self._history), recent(monitor.steps, monitor.costs, name, notes=monitor.notes)
        before = self._questions.beliefs[name]
        corrected = correct_beliefs(
            self.asker, name, now, steps, rows, self._trial, self._world, facts, self.cfg, self._rng, self._emit
        )
        if corrected:
            after = self._questions.beliefs[name]
            self._corrected.append(
                f"mass of the {name} {before.mass_kg:.3g} to {after.mass_kg:.3g} kg, "
                f"friction {before.friction:.2g} to {after.friction:.2g}."
            )
        return corrected

    def _correct_if_due(self, last: bool = False) -> None:
        """Correct the world model if a correction is due, stuck or not; plan and stage continue."""
        name = self._correction_schedule.due(self._history, last)
        if name is not None:
            self._correct(name, self._now)

    def _experience(self) -> Experience:
        task = self._trial.task
        return Experience(
            task=task.name,
            instruction=task.instruction,
            goals=[dict(goal) for goal in self._questions.facts["goals"]],
            numbers=self._numbers,
            plan=self._followed[0].plan,
            regions=self._followed[0].regions,
            then=self._followed[1:],
            beliefs={name: (one.mass_kg, one.friction) for name, one in self._questions.beliefs.items()},
            provenance={"success": True, "repairs": self._repairs, **self._provenance},
        )

"""Score of a plan by its outcome: one short episode with a free-flying hand in the true world."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from coral.contact.control.plan_latency import PlanLatency
from coral.contact.control.planner_limits import PlannerLimits
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.cost.stages import Strategy
from coral.contact.cost_program import CostError
from coral.contact.cost_program.worker import CostWorker
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import Loader, PlanAnswer, in_process, make_strategy
from coral.contact.plan.plan_check import judge_plan
from coral.contact.plan.sampled_states import sample_states
from coral.contact.scene.observation import Observation
from coral.contact.scene.task import Task
from coral.contact.scene.trial import PhysicalParameters, Trial
from coral.contact.thinker.progress_monitor import OuterCfg, ProgressMonitor
from coral.contact.thinker.strategist import FixedStrategist, NoStrategy, PlanReport
from coral.contact.thinker.unified_question import UnifiedAnswer
from coral.exam.contact_scenes import trial_from_json
from coral.exam.contact_score import score_estimates, score_regions
from coral.exam.worth import Worth

LIMIT_S = 24.0
"""Simulated time in which a plan has to succeed; the rules need 2 to 19 s for these tasks, most where the mass that is
believed is a quarter of the true one."""
SAMPLES = 16
LATENCY = "fixed:0.02"
"""The world's time that a plan with this many rollouts takes while an answer is scored."""


@dataclass(frozen=True)
class FollowedPlan:
    """A plan with the beliefs and contact regions with which it is followed."""

    answer: PlanAnswer
    beliefs: Mapping[str, PhysicalParameters]
    regions: RegionsAnswer


class PlanFollower(FixedStrategist):
    """Verifies one plan and follows it without asking again. Keeps the history of an outer loop that does not step in.

    Args:
        plan: The plan to follow.
        load: Loads the plan's cost programs.
    """

    def __init__(self, plan: FollowedPlan, load: Loader) -> None:
        self._plan, self._load = plan, load
        self.monitor = ProgressMonitor(OuterCfg(), tuple(plan.answer.names))

    def begin(self, trial: Trial, first: Observation, world: PlanningWorld) -> Strategy:
        """Set the beliefs and make a strategy of the plan.

        Raises:
            NoStrategy: The plan is refused; the text is the code of the refusal.
        """
        plan, sizes = self._plan, {name: trial.size(name) for name in trial.objects}
        world.believe(plan.beliefs)
        refusal = judge_plan(plan.answer, world.schema, sample_states(world, first, sizes), self._load).refusal
        if refusal is not None:
            raise NoStrategy(refusal.code)
        return make_strategy("answer", plan.answer, plan.regions, world.schema, sizes, self._load)

    def on_plan(self, report: PlanReport) -> Strategy | None:
        """Record the transitions taken, the plan's cost and its contacts."""
        self.monitor.update(report)
        return None


def episode_cfg() -> EpisodeCfg:
    """Return the configuration of a short episode: poses from the simulator, few samples, no report."""
    cfg = EpisodeCfg(poses="ground-truth")
    controller = replace(cfg.controller, mppi=replace(cfg.controller.mppi, samples=SAMPLES))
    return replace(cfg, controller=controller, record=replace(cfg.record, states=False, report=False))


def scored_cfg() -> EpisodeCfg:
    """Return the configuration of the episode that scores an answer: the time of planning is charged."""
    cfg = episode_cfg()
    return replace(cfg, planning=replace(cfg.planning, latency=LATENCY))


def exam_limits() -> PlannerLimits:
    """Return the limits of the planner that follows an answer, for its question."""
    cfg = scored_cfg()
    late = PlanLatency(LATENCY, cfg.planning.step_s, cfg.replan_steps, cfg.controller.horizon)
    step_s = cfg.planning.step_s
    return PlannerLimits(
        cfg.controller, step_s, late.expected_steps() * step_s, late.plan_s, cfg.reactive.force_limit_n
    )


def short_task(task: Task) -> Task:
    """Return a task with the time limit of the episode that scores an answer."""
    return task.model_copy(update={"time_limit_s": LIMIT_S})


def follow(
    trial: Trial,
    plan: FollowedPlan,
    load: Loader = in_process,
    observers: Sequence[Any] = (),
    cfg: EpisodeCfg | None = None,
) -> dict[str, Any]:
    """Follow a plan to its end, the time of planning charged. Return the metrics with `detail`, the end's reason."""
    with tempfile.TemporaryDirectory() as folder:
        strategist = PlanFollower(plan, load)
        trial = replace(trial, task=short_task(trial.task))
        episode = Episode(trial, "hand", strategist, cfg or scored_cfg(), Path(folder) / "run", variant="exam")
        return {**episode.run(observers), "detail": episode.detail}


def score_plan(key: Mapping[str, Any], facts: Mapping[str, Any], answer: PlanAnswer) -> Worth:
    """Score a plan: 1 if it succeeds in time, 0 if it does not or is refused."""
    return _outcome(key, followed_plan(key, answer))


def followed_plan(key: Mapping[str, Any], answer: PlanAnswer) -> FollowedPlan:
    """Return a plan with the beliefs and the contact regions of its question's key."""
    regions = RegionsAnswer.model_validate(key["regions"])
    # The regions of the key name other stages than this answer does: each region is valid for all stages.
    held = {
        name: one.model_copy(update={"regions": [r.model_copy(update={"stage": ""}) for r in one.regions]})
        for name, one in regions.root.items()
    }
    return FollowedPlan(answer, _physical(key["beliefs"]), RegionsAnswer(held))


def score_unified(key: Mapping[str, Any], facts: Mapping[str, Any], answer: UnifiedAnswer) -> Worth:
    """Score a unified answer: half by the outcome of its plan, a quarter each by its estimates and its regions."""
    scene = {**facts, "stages": answer.plan.names}
    parts = [score_estimates(key, facts, answer.estimates), score_regions(key, scene, answer.places)]
    if any(part.why.startswith("refused") for part in parts):
        return Worth(0.0, "; ".join(part.why for part in parts))
    outcome = _outcome(key, FollowedPlan(answer.plan, answer.estimates.physical(), answer.places))
    why = "; ".join([outcome.why, *(part.why for part in parts)])
    return Worth(0.5 * outcome.score + 0.25 * (parts[0].score + parts[1].score), why)


def _outcome(key: Mapping[str, Any], plan: FollowedPlan) -> Worth:
    with CostWorker() as worker:
        try:
            metrics = follow(trial_from_json(key["trial"]), plan, worker.load)
        except CostError as error:
            return Worth(0.0, f"refused: {error.code}")
    if metrics["success"]:
        return Worth(1.0, f"success after {metrics['sim_time_s']:.1f} s")
    refused = metrics["end_reason"] == "no-strategy"
    return Worth(0.0, f"refused: {metrics['detail']}" if refused else f"no success: {metrics['end_reason']}")


def _physical(beliefs: Mapping[str, Mapping[str, float]]) -> dict[str, PhysicalParameters]:
    return {name: PhysicalParameters(one["mass_kg"], one["friction"]) for name, one in beliefs.items()}

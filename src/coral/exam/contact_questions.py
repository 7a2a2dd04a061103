"""The contact questions of a set: sampled scenes, the prompts that an episode would render, the truth as key."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from coral.advisor.consult import Outcome
from coral.advisor.prompt import render
from coral.advisor.question import Picture
from coral.contact.control.planning_world import PlanningCfg, PlanningWorld
from coral.contact.episode.episode import Episode
from coral.contact.perception.advisor_camera import AdvisorCameraCfg, make_advisor_camera, to_picture
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.scene_labels import PictureLabels, label_picture
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer, in_process
from coral.contact.scene.geometry import rotate
from coral.contact.scene.observation import Observation
from coral.contact.scene.prior_beliefs import prior_beliefs
from coral.contact.scene.trial import PhysicalParameters, Trial, sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.correction import TouchHistory, correct_beliefs
from coral.contact.thinker.diagnosis import diagnose
from coral.contact.thinker.history_rows import recent
from coral.contact.thinker.pose_question import pose_facts, pose_prompt
from coral.contact.thinker.questions import regions_prompt
from coral.contact.thinker.recorded_answers import recorded_answers
from coral.contact.thinker.repair_prompt import fit_prompt, repair_values
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.thinker.scene_text import world_prompt
from coral.contact.thinker.think_cfg import ThinkCfg
from coral.contact.thinker.unified_question import unified_prompt
from coral.contact.world_model.parameter_estimates import belief_prompt
from coral.contact.worlds.registry import make_world
from coral.exam.contact_outcome import FollowedPlan, PlanFollower, episode_cfg, exam_limits, short_task
from coral.exam.contact_scenes import looks_like, made_of, trial_to_json
from coral.exam.contact_touch import touches
from coral.exam.item import ExamItem

TASKS = ("push-pick-board", "pick-box", "pick-clutter", "push-force", "flip-box", "flip-wall")
SHORT = ("flip-box", "pick-box", "push-force")
"""Tasks that a plan finishes in a few seconds: only these are used where an episode scores the answer."""
BAD_S, PUSHED_S = 2.0, 4.0
"""Simulated time of the question about a bad plan, and of the question about a wrong belief."""
Say = Callable[[str], None]


@dataclass(frozen=True)
class Seen:
    """The first observation of a trial: measurements, picture, and the scene as facts."""

    trial: Trial
    now: Observation
    frame: RgbdFrame
    facts: dict[str, Any]
    beliefs: dict[str, PhysicalParameters]
    """As a recorded model estimated them, or else prior ones; later questions state them."""

    @property
    def pictures(self) -> tuple[Picture, ...]:
        """Return the camera's pictures."""
        return (to_picture(self.frame),)

    @property
    def labelled(self) -> Picture:
        """Return the picture with names and axes drawn in."""
        return label_picture(self.frame, PictureLabels.of(self.trial.task, self.now))

    @property
    def believed(self) -> dict[str, Any]:
        """Return the facts with the beliefs about masses and frictions filled in."""
        return dict(scene_facts(self.trial, self.now, self.beliefs))


def contact_items(seed: int, counts: Mapping[str, int], say: Say = lambda text: None) -> list[ExamItem]:
    """Make the questions of all kinds.

    Args:
        seed: Of trials and of the errors put into plans and beliefs.
        counts: Number of questions of each kind.
        say: Receives progress messages.
    """
    makers = {
        "physical-parameters": _parameters,
        "contact-regions": _regions,
        "object-poses": _poses,
        "parameter-repair": _correction,
        "cost-function": plan_question,
        "cost-repair": _repair,
        "unified": _unified,
    }
    found = []
    for kind, count in counts.items():
        tasks = SHORT if kind in ("cost-function", "cost-repair", "unified") else TASKS
        if kind == "parameter-repair":
            tasks = ("push-force", "flip-wall", "push-pick-board")
        tried = made = 0
        while made < count and tried < 4 * count:
            name, number = tasks[tried % len(tasks)], tried // len(tasks)
            item = makers[kind](name, 100 * seed + number)
            tried += 1
            if item is None:
                continue
            found.append(replace(item, id=f"{kind}-{made:03d}", kind=kind, group=f"{name}-{number}"))
            made += 1
        say(f"{made} {kind} questions")
    return found


def _observe(trial: Trial) -> Seen:
    world = make_world("hand", trial, PlanningCfg().step_s)
    try:
        now = world.reset()
        look = make_advisor_camera(
            world, trial, TrackedCfg(), AdvisorCameraCfg(), np.random.default_rng([trial.seed, 5])
        )
        frame = look()
    finally:
        world.close()
    assert frame is not None
    facts = dict(scene_facts(trial, now))
    recorded = recorded_answers(trial.task.name)
    return Seen(trial, now, frame, facts, prior_beliefs(trial) if recorded is None else recorded.parameters.physical())


def _item(
    kind: str, prompt: Mapping[str, Any], facts: Mapping[str, Any], key: Mapping[str, Any], *pictures: Picture
) -> ExamItem:
    text, version = render(kind, prompt)
    return ExamItem(
        id="", kind=kind, group="", prompt=text, prompt_version=version, facts=facts, pictures=pictures, key=key
    )


def _true_parameters(trial: Trial) -> dict[str, Any]:
    return {
        name: {"mass_kg": item.physical.mass_kg, "friction": item.physical.friction}
        for name, item in trial.objects.items()
    }


def _parameters(task: str, seed: int) -> ExamItem:
    seen = _observe(made_of(load_task(task), seed))
    prompt = belief_prompt(cast(Any, seen.facts))
    return _item(
        "physical-parameters", prompt, seen.facts, {"parameters": _true_parameters(seen.trial)}, *seen.pictures
    )


def _poses(task: str, seed: int) -> ExamItem:
    seen = _observe(made_of(load_task(task), seed))
    facts = pose_facts(seen.trial, seen.now, seen.frame)
    poses = {}
    for name, item in seen.trial.objects.items():
        middle = np.array(facts["objects"][name]["middle_m"])
        poses[name] = {
            "position": [float(v) for v in item.pose.position + rotate(item.pose.quaternion, middle)],
            "quaternion": [float(v) for v in item.pose.quaternion],
            "symmetry": looks_like(seen.trial, name),
        }
    return _item("object-poses", pose_prompt(facts), facts, {"poses": poses}, *seen.pictures)


def _regions(task: str, seed: int) -> ExamItem:
    seen = _observe(made_of(load_task(task), seed))
    facts = _plan_facts(seen)
    plan = _recorded(task)[0]
    facts["stages"] = plan.names
    prompt = regions_prompt(_shared_prompt(seen, facts), plan)
    return _item("contact-regions", prompt, facts, {"touches": touches(seen.trial)}, seen.labelled)


def plan_question(task: str, seed: int) -> ExamItem:
    """Make the question for a plan of a trial, as an episode asks it at its beginning.

    An answer is followed without contact regions: those of another plan would not fit.
    """
    seen = _observe(sample_trial(load_task(task), seed))
    facts = _plan_facts(seen)
    key = _plan_key(seen.trial, seen, RegionsAnswer({}))
    return _item("cost-function", _shared_prompt(seen, facts), facts, key, seen.labelled)


def _unified(task: str, seed: int) -> ExamItem:
    seen = _observe(sample_trial(load_task(task), seed + 50))
    facts = {**seen.facts, "diagnoses": [], "contact_strategy": True}
    prompt = unified_prompt(_shared_prompt(seen, facts), ThinkCfg())
    key = {
        "trial": trial_to_json(seen.trial),
        "parameters": _true_parameters(seen.trial),
        "touches": touches(seen.trial),
    }
    return _item("unified", prompt, facts, key, seen.labelled)


def _repair(task: str, seed: int) -> ExamItem | None:
    """Make a question about a plan that was followed for a while with one error in it; None if its episode fails."""
    seen = _observe(sample_trial(load_task(task), seed + 70))
    plan, regions = _recorded(task)
    bad = _break_plan(plan, seed)
    felt = _follow_for(seen.trial, FollowedPlan(bad, seen.beliefs, regions), BAD_S)
    if felt is None or not felt.follower.monitor.steps:
        return None
    name = next(iter(seen.trial.objects))
    monitor, now = felt.follower.monitor, felt.now
    monitor.attempts = monitor.cfg.n_retry  # as where an episode asks
    later = replace(
        seen.trial,
        objects={key: replace(item, pose=now.objects[key]) for key, item in seen.trial.objects.items()},
    )
    after = replace(seen, trial=later, now=now, frame=felt.frame)
    diagnoses = [diagnose(monitor.steps, name, 0, 0.0)]
    facts = {**_plan_facts(after), "diagnoses": diagnoses}
    prompt = {**_shared_prompt(after, facts), **repair_values(bad, regions, monitor, name, diagnoses)}
    key = _plan_key(later, after, regions)
    return _item("cost-repair", fit_prompt("cost-repair", prompt), facts, key, after.labelled)


def _correction(task: str, seed: int) -> ExamItem | None:
    """Make a question about a belief that was wrong by a factor while the object was pushed; None if none came up."""
    seen = _observe(sample_trial(load_task(task), seed + 30))
    rng = np.random.default_rng([seed, 43])
    name = next(iter(seen.trial.objects))
    true = seen.trial.objects[name].physical
    wrong = PhysicalParameters(
        float(np.clip(true.mass_kg * math.exp(rng.choice([-1, 1]) * rng.uniform(0.7, 1.6)), 0.01, 15.0)),
        float(np.clip(true.friction * math.exp(rng.choice([-1, 1]) * rng.uniform(0.4, 0.9)), 0.05, 1.6)),
    )
    plan, regions = _recorded(task)
    beliefs = {**seen.beliefs, name: wrong}
    capture = _RecordingAsker()
    felt = _follow_for(seen.trial, FollowedPlan(plan, beliefs, regions), PUSHED_S, _ask_correction(capture, name, seen))
    if felt is None or capture.asked is None:
        return None
    facts, prompt = capture.asked
    key = {"object": name, "parameters": _true_parameters(seen.trial)[name]}
    return _item("parameter-repair", prompt, facts, key)


def _shared_prompt(seen: Seen, facts: Mapping[str, Any]) -> dict[str, Any]:
    """Return the part of the prompt that all questions about a plan share."""
    world = PlanningWorld(seen.trial, seen.beliefs, seen.now, PlanningCfg())
    try:
        return world_prompt(facts, short_task(seen.trial.task), world.schema, ThinkCfg(), exam_limits())
    finally:
        world.close()


def _plan_facts(seen: Seen) -> dict[str, Any]:
    return {**seen.believed, "diagnoses": [], "contact_strategy": True}


def _recorded(task: str) -> tuple[PlanAnswer, RegionsAnswer]:
    """Return the plan and the regions of the recorded model."""
    found = recorded_answers(task)
    assert found is not None
    return found.plan, found.regions


def _plan_key(trial: Trial, seen: Seen, regions: RegionsAnswer) -> dict[str, Any]:
    return {
        "trial": trial_to_json(trial),
        "beliefs": {k: {"mass_kg": one.mass_kg, "friction": one.friction} for k, one in seen.beliefs.items()},
        "regions": regions.model_dump(mode="json"),
    }


def _break_plan(plan: PlanAnswer, seed: int) -> PlanAnswer:
    """Return a plan that passes the checks and gets stuck: its first stage never ends, or aims beside the object."""
    first = plan.stages[0]
    if seed % 2:
        first = first.model_copy(update={"done": "self.time > 900.0"})
    else:
        aside = "self.ee_pos + np.array([0.0, 0.12, 0.0])"
        first = first.model_copy(update={"code": first.code.replace("self.ee_pos", f"({aside})")})
    return plan.model_copy(update={"stages": [first, *plan.stages[1:]]})


@dataclass
class _Interrupted:
    """State of an episode when it was stopped."""

    follower: PlanFollower
    now: Observation
    frame: RgbdFrame


class _RecordingAsker:
    """An asker that records the question and asks no advisor."""

    asked: tuple[Mapping[str, Any], Mapping[str, Any]] | None = None

    def ask(
        self, kind: str, answer_type: type[Any], facts: Mapping[str, Any], prompt: Mapping[str, Any], verify: Any
    ) -> Outcome[Any]:
        """Record the question; there is no answer."""
        self.asked = facts, prompt
        return Outcome(answer=None, question=None, attempts=0, failure="kept")


def _ask_correction(capture: _RecordingAsker, name: str, seen: Seen) -> Callable[[Episode, PlanFollower], None]:
    def correct(episode: Episode, follower: PlanFollower) -> None:
        planner = episode.planner
        facts = scene_facts(episode.trial, episode.now, dict(planner.beliefs[0]))
        steps = tuple(follower.monitor.steps)
        past = TouchHistory(steps, recent(steps, follower.monitor.costs, name))
        correct_beliefs(
            cast(Any, capture),
            name,
            episode.now,
            past,
            episode.trial,
            planner,
            cast(Any, facts),
            ThinkCfg(),
            np.random.default_rng([episode.trial.seed, 3]),
            lambda event, **fields: None,
        )

    return correct


def _follow_for(
    trial: Trial, plan: FollowedPlan, seconds: float, then: Callable[[Episode, PlanFollower], None] | None = None
) -> _Interrupted | None:
    """Follow a plan for some seconds; None if its episode ends earlier or the plan is refused."""
    follower = PlanFollower(plan, in_process)

    class Stop:
        reached = False
        frame: RgbdFrame | None = None

        def tick(self, episode: Episode) -> None:
            if not self.reached and episode.t >= seconds:
                self.reached = True
                self.frame = episode.look()
                if then is not None:
                    then(episode, follower)

        def stop_requested(self) -> str:
            return "stopped by the exam" if self.reached else ""

    stop = Stop()
    with tempfile.TemporaryDirectory() as folder:
        episode = Episode(trial, "hand", follower, episode_cfg(), Path(folder) / "run", variant="exam")
        episode.run([stop])
    return None if stop.frame is None else _Interrupted(follower, episode.now, stop.frame)

"""A running contact task on the live page: an observer that shows it and applies the page's pause, speed and stop."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from coral.contact.episode.episode import Episode
from coral.view.live.history import History
from coral.view.live.pace import Pace
from coral.view.live.page import LivePage
from coral.view.live.state import Chart, LiveState, Number
from coral.view.live.story import Story
from coral.view.live.task_controls import TaskControls
from coral.view.live.task_scene import LEGEND, PLANNED, VIEW, TaskScene, lines
from coral.view.live.task_story import told_of_task
from coral.view.pictures import RGB
from coral.view.run import Record

Array = NDArray[np.float64]
HARD_N = 30.0
"""A force above this is shown in red: the limit on the impedance's pull."""
COLORS: tuple[RGB, ...] = (
    (11, 100, 112),
    (214, 52, 44),
    (255, 133, 0),
    (120, 170, 60),
    (150, 120, 200),
    (90, 90, 100),
    (0, 150, 170),
    (190, 150, 60),
)
EFFECTIVE = (
    "Effective samples: how many of the plan's rehearsals really shape it; 1 means that a single one was far better."
)


class LiveTask:
    """Observes one episode without changing its random numbers or its simulated time.

    Args:
        episode: The episode, before it runs.
        page: The page.
        pace: The viewer's requests.
        controls: The page's buttons.
    """

    def __init__(self, episode: Episode, page: LivePage, pace: Pace, controls: TaskControls) -> None:
        self.page, self.pace, self.controls = page, pace, controls
        self._episode = episode
        self.story = Story()
        self._scene = TaskScene(episode.trial)
        self._terms: dict[str, History] = {}
        self._force = History(("force",))
        self._trail: list[Array] = []
        self._last: Mapping[str, float] = {}
        self._plan_event: Record = {}
        self._about = f"advisor {episode.advisor}, variant {episode.variant}, seed {episode.trial.seed}"
        self._title = episode.trial.task.title or episode.trial.task.name
        episode.listeners.append(self.hear)
        scene = self._scene
        page.show(
            LiveState(title=self._title, about=self._about, ground=scene.ground, view=VIEW, markers=scene.markers)
        )

    def hear(self, event: Record) -> None:
        """Handle one event of the episode."""
        if event["event"] == "plan":
            self._plan_event = event
            terms = event.get("terms")
            if isinstance(terms, dict):
                self._add_terms(float(event["t"]), str(event["stage"]), terms)
            return
        self.story = told_of_task(self.story, {"step": 1, **event})
        if event["event"] == "end" and self._trail:
            self.page.show(self.state(self._episode))

    def tick(self, episode: Episode) -> None:
        """Show a plan's moment if the page is ready, then wait as the page requires."""
        self._force.add(episode.t, float(np.linalg.norm(episode.now.wrench[:3])))
        self._trail.append(episode.now.tool.position.copy())
        if episode.end_reason:
            return  # its event comes last, and tells what did not hold
        if self.page.due():
            self.page.show(self.state(episode))
        if self.pace.paused:
            self.page.show(self.state(episode))
        self.pace.stand_still(lambda: self._meanwhile(episode))
        if not getattr(episode.world, "in_real_time", False):
            self.pace.keep(episode.t)
        if self.pace.stop:
            self.page.show(self.state(episode, status=f"ended: {self.pace.stop}"))

    def stop_requested(self) -> str:
        """Return why the operator ended the task, or ""."""
        return self.pace.stop

    def _meanwhile(self, episode: Episode) -> None:
        if self.page.due(only_new=True):
            self.page.show(self.state(episode))

    def _add_terms(self, t: float, stage: str, terms: Mapping[str, float]) -> None:
        names = tuple(terms)
        if stage not in self._terms or self._terms[stage].names != names:
            self._terms[stage] = History(names)
        self._terms[stage].add(t, *(math.nan if terms[name] is None else float(terms[name]) for name in names))
        self._last = terms
        self.controls.offer(stage, names)

    def state(self, episode: Episode, status: str = "") -> LiveState:
        """Return the present state of the episode."""
        now, plan = episode.now, episode.latest_plan
        force = now.wrench[:3]
        ended = f"ended: {episode.end_reason}" if episode.end_reason else "paused" if self.pace.paused else "running"
        return LiveState(
            title=self._title,
            about=self._about,
            status=status or ended,
            t=episode.t,
            until_s=episode.time_limit_s,
            curves_s=min(max(10.0, 1.25 * episode.t), episode.time_limit_s),
            numbers=self._numbers(episode, float(np.linalg.norm(force))),
            log=self.story.log,
            ground=self._scene.ground,
            view=VIEW,
            lines=lines(
                np.array(self._trail[:: max(1, len(self._trail) // 600)]),
                now.tool.position,
                force,
                None if plan is None else plan.paths,
            ),
            markers=self._scene.markers,
            bodies=self._scene.bodies(now.tool, now.opening_m, now.objects),
            charts=self._charts(),
            legend=LEGEND + PLANNED,
            note=EFFECTIVE,
        )

    def _numbers(self, episode: Episode, force_n: float) -> tuple[Number, ...]:
        holding = episode.referee.holding
        return (
            *plan_numbers(self.story.state, self._plan_event, force_n),
            Number(
                name="conditions",
                value=f"{sum(holding)} of {len(holding)}" if holding else "-",
                tone="good" if holding and all(holding) else "plain",
            ),
            Number(name="weights changed", value=str(episode.interventions)),
        )

    def _charts(self) -> tuple[Chart, ...]:
        t, values = self._force.curves(("force",))
        return (force_chart(t, values), *(terms_chart(stage, found) for stage, found in self._terms.items()))


def plan_numbers(stage: str, plan: Record, force_n: float) -> tuple[Number, ...]:
    """Return the numbers of a moment: active stage, the plan's cost and effective samples, and the measured force."""
    cost, effective = plan.get("cost"), plan.get("ess")
    return (
        Number(name="stage", value=stage or "-"),
        Number(name="cost of the plan", value="-" if cost is None else f"{float(cost):.2f}"),
        Number(name="effective samples", value="-" if effective is None else f"{float(effective):.1f}"),
        Number(name="force", value=f"{force_n:.1f} N", tone="bad" if force_n > HARD_N else "plain"),
    )


def force_chart(t: Array, values: Array) -> Chart:
    """Return the curve of the force on the hand, Shapes (N,) and (1, N), N."""
    return Chart(title="Force on the hand (N)", names=("force",), t=t, values=values, colors=COLORS[1:2])


def terms_chart(stage: str, found: History) -> Chart:
    """Return the curves of a stage's terms over simulated time; as many as there are colours."""
    names = found.names[: len(COLORS)]
    t, values = found.curves(names)
    return Chart(title=f"Cost by term, stage {stage}", names=names, t=t, values=values, colors=COLORS[: len(names)])

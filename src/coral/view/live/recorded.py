"""A recorded run folder, possibly of a killed run, on the live page: any moment of it, or played like a film."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from itertools import accumulate
from typing import Protocol

import numpy as np

from coral.reef.world.geometry import Frame
from coral.reef.world.world import ReefWorld
from coral.view.decisions import decisions
from coral.view.live import reef_scene
from coral.view.live.history import thinned
from coral.view.live.pace import Pace
from coral.view.live.page import LivePage
from coral.view.live.state import Chart, LiveState
from coral.view.live.story import Story, told
from coral.view.run import RunFolder
from coral.view.runmap import scene_at, step_at

NOTE = "The plan and its rollouts are not recorded."


class RecordedRun:
    """The moments of one run folder."""

    def __init__(self, run: RunFolder) -> None:
        self.run = run
        self.duration_s = run.duration_s
        self._decisions = decisions(run)
        self._times = [float(event["t"]) for event in run.events]
        self._stories = list(accumulate(run.events, told, initial=Story()))
        try:
            self._truth = reef_scene.truth(ReefWorld.model_validate(run.world))
        except ValueError:
            self._truth = ()
        config = run.config
        self.title = str(run.world.get("name") or config.get("world") or run.path.name)
        words = [f"{key} {config[key]}" for key in ("advisor", "variant", "seed") if key in config]
        self._about = ", ".join([*words, "recorded" if run.complete else "recorded, cut off while it ran"])

    def at(self, t: float, *, playing: bool = False) -> LiveState:
        """Return the state of the run at simulated time `t` (s)."""
        run = self.run
        times = run.column("t")
        k = int(np.searchsorted(times, t + 1e-6))
        story = self._stories[bisect_right(self._times, t + 1e-6)]
        scene = scene_at(run, self._decisions, t)
        coverage, speed = (_last(run.column(name)[:k]) for name in ("coverage", "u"))
        status = "playing" if playing else "paused"
        return LiveState(
            title=self.title,
            about=self._about,
            status=f"ended: {story.ended}" if story.ended else status,
            t=t,
            until_s=self.duration_s,
            numbers=reef_scene.numbers(story, coverage, speed),
            asked=story.asked,
            answered=story.answered,
            log=story.log,
            ground=reef_scene.ground(scene),
            lines=(*reef_scene.lines(scene), *self._truth),
            markers=reef_scene.markers(scene),
            bodies=reef_scene.robot(scene.pose),
            follow="robot",
            pictures=reef_scene.cameras(self._frame(t)),
            charts=self._charts(k),
            legend=reef_scene.LEGEND,
            note=NOTE,
        )

    def _frame(self, t: float) -> Frame | None:
        step = step_at(self.run, t)
        return None if step is None else self.run.camera_frame(step)

    def _charts(self, k: int) -> tuple[Chart, ...]:
        run = self.run
        t, (coverage, commanded, driven, clearance) = thinned(
            run.column("t")[:k], np.array([run.column(name)[:k] for name in ("coverage", "v_cmd", "u", "clearance")])
        )
        return (
            Chart(
                title="Coverage (%)",
                names=("coverage",),
                t=t,
                values=100 * coverage[None],
                bounds=(0.0, 105.0),
                colors=((11, 100, 112),),
            ),
            Chart(
                title="Forward speed (m/s)",
                names=("commanded", "driven"),
                t=t,
                values=np.array([commanded, driven]),
                colors=((150, 160, 172), (25, 90, 230)),
            ),
            Chart(
                title="Hull to nearest obstacle (m)",
                names=("clearance",),
                t=t,
                values=clearance[None],
                colors=((214, 52, 44),),
            ),
        )


class Replayable(Protocol):
    """What can be played: the moments of a run."""

    duration_s: float

    def at(self, t: float, *, playing: bool = False) -> LiveState:
        """Return the state at simulated time `t` (s)."""
        ...


class Player:
    """The playback position of the page; the page's slider and buttons change it from other threads."""

    def __init__(self, recording: Replayable, pace: Pace, t: float = 0.0) -> None:
        self.recording, self.pace = recording, pace
        self.t = t
        self._stale = True

    def seek(self, t: float) -> None:
        """Go to simulated time `t` (s)."""
        self.t = min(max(t, 0.0), self.recording.duration_s)
        self._stale = True

    def play(self, playing: bool) -> None:
        """Play, from the beginning if the end was reached, or pause."""
        if playing and self.t >= self.recording.duration_s:
            self.seek(0.0)
        self.pace.paused = not playing
        self._stale = True

    def advance(self, wall_s: float) -> None:
        """Advance by `wall_s` seconds of wall time."""
        if self.pace.paused:
            return
        self.t = min(self.t + wall_s * self.pace.speed, self.recording.duration_s)
        self._stale = True
        if self.t >= self.recording.duration_s:
            self.pace.paused = True

    def run(self, page: LivePage, clock: Callable[[], float], wait: Callable[[float], object]) -> None:
        """Play to all viewers until interrupted."""
        before = clock()
        while not self.pace.stop:
            now = clock()
            self.advance(now - before)
            before = now
            if page.due(only_new=not self._stale):
                self._stale = False
                page.show(self.recording.at(self.t, playing=not self.pace.paused))
            wait(0.05)


def _last(values: np.ndarray) -> float:  # type: ignore[type-arg]
    """Return the last recorded number; 0 if there is none."""
    known = values[np.isfinite(values)]
    return float(known[-1]) if len(known) else 0.0

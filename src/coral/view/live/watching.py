"""Observers that let the viewer pace a run and see its present plan. They read; nothing of the run is changed."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Literal

import numpy as np

from coral.contact.worlds.robot_world import in_real_time
from coral.terminal import tell
from coral.view.live.controls import Pace, RunControls
from coral.view.live.viewer import PERIOD_S, Sketch, Stroke, Viewer

PLAN, ROLLOUT, REFERENCE, CARRIED = "#00aabe", "#9678c8", "#783ca0", "#ff8500"
ROLLOUTS = 48
"""Number of the sampled rollouts that are drawn."""


class WatchedRun:
    """Applies pause, speed and stop between two steps, and passes on the plan, as sketched, while somebody looks.

    Without a pace nothing waits. A run in real time keeps its own.
    """

    def __init__(self, viewer: Viewer, pace: Pace | None, sketch: Sketch, *, real_time: bool = False) -> None:
        self.viewer, self.pace, self._sketch, self._real_time = viewer, pace, sketch, real_time
        self._due = 0.0

    def tick(self, run: Any) -> None:
        """Show a moment of a mission or an episode, then wait as the page requires."""
        now, clock = self.viewer.now, time.monotonic()
        if run.end_reason:
            now.status, now.strokes = f"ended: {run.end_reason}", ()
            return
        now.status = self.status(run)
        if self.viewer.watched and clock >= self._due:
            now.strokes = self._sketch(run)
            self._due = clock + PERIOD_S
        if self.pace is None:
            return
        if self.pace.paused:
            now.status = "paused"
        if self.pace.stand_still() and hasattr(run, "stood_still"):
            run.stood_still(time.monotonic() - clock)
        if not self._real_time:
            self.pace.keep(run.t)
        if self.pace.stop:
            now.status = f"ended: {self.pace.stop}"

    def status(self, run: Any) -> str:
        """Return the state of the run in words."""
        return "running"

    def stop_requested(self) -> str:
        """Return why the operator ended the run, or ""."""
        return "" if self.pace is None else self.pace.stop


@contextmanager
def watching_run(
    run: Any, system: Literal["reef", "contact"], *, port: int, speed: float, wait: bool
) -> Iterator[list[WatchedRun]]:
    """Show a mission or an episode in a browser, from before its first step until its end.

    Port 0 chooses one. The speed limit is in multiples of real time; 0 for none. With `wait`, the run waits for the
    first viewer, and the page stays after its end until Ctrl-C.
    """
    pace = Pace(speed)
    sketch: Sketch = reef_sketch if system == "reef" else task_sketch
    if system == "reef":
        what, real_time = "mission", False
        controls = RunControls(pace, instruct=run.instructing)
    else:
        what, real_time = "task", in_real_time(run.world)
        stop_now = getattr(run.world, "stop_now", None)
        controls = RunControls(pace, what="task", weights=run.weights, stop_now=stop_now)
    with Viewer(run.writer.folder, controls, port=port, flag="--live-port") as viewer:
        if wait:
            viewer.wait_for_viewer(what)
        else:
            tell(f"watch the {what} at {viewer.url}")
        yield [WatchedRun(viewer, pace, sketch, real_time=real_time)]
        if wait:
            viewer.stay()


class WatchedSurvey(WatchedRun):
    """A survey at sea: the page tells its state, its battery and what it asks of the operator."""

    def waiting(self, lines: tuple[str, ...]) -> None:
        """Show the preflight list."""
        self.viewer.now.status, self.viewer.now.note = "preflight", "\n".join(lines)

    def tick(self, run: Any) -> None:
        """Show a moment of the survey."""
        super().tick(run)
        battery = run.report.battery_fraction
        self.viewer.now.numbers = () if battery is None else (("battery", f"{battery:.0%}"),)
        self.viewer.now.note = run.notice

    def status(self, run: Any) -> str:
        """Return the vehicle's state and its reason."""
        states = run.states
        return f"{states.state.value}{f' - {states.reason}' if states.reason else ''}"


def reef_sketch(mission: Any) -> Sequence[Stroke]:
    """Draw the plan of a survey, some of its rollouts if the controller keeps them, and the path to the goal."""
    plan, path = mission.pilot.plan, mission.pilot.monitor.path
    found = []
    if plan is not None and plan.rollouts is not None and plan.feasible is not None:
        some = plan.rollouts[plan.feasible]
        some = some[:: max(1, len(some) // ROLLOUTS), ::2, :2]
        found += [Stroke(name="rollouts", color=ROLLOUT, points=one, width=1.0, layer="rollouts") for one in some]
    if path is not None:
        found.append(Stroke(name="path to the goal", color=REFERENCE, points=np.asarray(path)[:, :2]))
    if plan is not None and plan.path is not None:
        found.append(Stroke(name="plan", color=PLAN, points=plan.path[:, :2], width=4.0))
    return found


def task_sketch(episode: Any) -> Sequence[Stroke]:
    """Draw the best rollout of the present plan, the objects in it, and some of the other rollouts."""
    paths = None if episode.latest_plan is None else episode.latest_plan.paths
    if paths is None:
        return ()
    return [
        *(Stroke(name="rollouts", color=ROLLOUT, points=one, width=1.0, layer="rollouts") for one in paths.some),
        *(Stroke(name="objects in the plan", color=CARRIED, points=one, width=3.0) for one in paths.objects.values()),
        Stroke(name="plan", color=PLAN, points=paths.best, width=4.0),
    ]

"""A recorded contact run, possibly of a killed one, on the live page: any moment of it, or played like a film."""

from __future__ import annotations

from bisect import bisect_right
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.observation import BodyState
from coral.view.contact.replay import trial_of_run
from coral.view.live.history import History, thinned
from coral.view.live.live_task import EFFECTIVE, force_chart, plan_numbers, terms_chart
from coral.view.live.state import Chart, LiveState, Number
from coral.view.live.story import Story
from coral.view.live.task_scene import LEGEND, VIEW, TaskScene, lines
from coral.view.live.task_story import told_of_task
from coral.view.run import Record, RunFolder

Array = NDArray[np.float64]
NOTE = f"The plan and its rehearsals are not recorded. {EFFECTIVE}"


class RecordedTask:
    """The moments of one run folder.

    Args:
        run: The run.

    Raises:
        InputError: The folder has no task, or no seed.
    """

    def __init__(self, run: RunFolder) -> None:
        self.run, self.duration_s = run, run.duration_s
        trial = trial_of_run(run)
        self._names = tuple(trial.objects)
        self._scene = TaskScene(trial)
        self._times = [float(event["t"]) for event in run.events]
        self._stories = list(accumulate(run.events, told_of_task, initial=Story()))
        self._plans = run.select("plan")
        self._plan_times = [float(event["t"]) for event in self._plans]
        self.title = trial.task.title or trial.task.name
        config = run.config
        words = [f"{key} {config[key]}" for key in ("advisor", "variant", "seed") if key in config]
        self._about = ", ".join([*words, "recorded" if run.complete else "recorded, cut off while it ran"])

    def at(self, t: float, *, playing: bool = False) -> LiveState:
        """Return the state of the run at simulated time `t` (s)."""
        run = self.run
        row = max(0, int(np.searchsorted(run.column("t"), t + 1e-6)) - 1)
        story = self._stories[bisect_right(self._times, t + 1e-6)]
        status = "playing" if playing else "paused"
        shown: dict[str, object] = {}
        if len(run.column("t")):
            tool, force = self._pose("", row), self._columns(("fx", "fy", "fz"))[row]
            objects = {name: self._pose(f"{name}_", row) for name in self._names}
            trail = self._columns(("x", "y", "z"))[: row + 1]
            shown["lines"] = lines(trail[:: max(1, len(trail) // 600)], tool.position, np.nan_to_num(force))
            shown["bodies"] = self._scene.bodies(tool, float(np.nan_to_num(run.column("opening")[row])), objects)
        return LiveState(
            title=self.title,
            about=self._about,
            status=f"ended: {story.ended}" if story.ended else status,
            t=t,
            until_s=self.duration_s,
            numbers=self._numbers(story, row, t),
            log=story.log,
            ground=self._scene.ground,
            view=VIEW,
            markers=self._scene.markers,
            charts=self._charts(row, t),
            legend=LEGEND,
            note=NOTE,
            **shown,  # type: ignore[arg-type]
        )

    def _columns(self, names: tuple[str, ...]) -> Array:
        return np.stack([self.run.column(name) for name in names], axis=1)

    def _pose(self, prefix: str, row: int) -> BodyState:
        place = self._columns((f"{prefix}x", f"{prefix}y", f"{prefix}z"))[row]
        turn = self._columns(tuple(f"{prefix}{part}" for part in ("qw", "qx", "qy", "qz")))[row]
        known = np.isfinite([*place, *turn]).all()
        return BodyState(place, turn) if known else BodyState(np.array([0.0, 0.0, -1.0]), np.array([1.0, 0, 0, 0]))

    def _numbers(self, story: Story, row: int, t: float) -> tuple[Number, ...]:
        index = bisect_right(self._plan_times, t + 1e-6) - 1
        plan: Record = self._plans[index] if index >= 0 else {}
        force = self._columns(("fx", "fy", "fz"))
        return plan_numbers(story.state, plan, float(np.linalg.norm(force[row])) if len(force) else 0.0)

    def _charts(self, row: int, t: float) -> tuple[Chart, ...]:
        run = self.run
        force = np.linalg.norm(self._columns(("fx", "fy", "fz"))[: row + 1], axis=1)
        times, values = thinned(run.column("t")[: row + 1], force[None])
        found: dict[str, History] = {}
        for when, plan in zip(self._plan_times, self._plans, strict=True):
            terms = plan.get("terms")
            if when > t + 1e-6 or not isinstance(terms, dict):
                continue
            stage, names = str(plan.get("stage")), tuple(terms)
            if stage not in found or found[stage].names != names:
                found[stage] = History(names)
            found[stage].add(when, *(np.nan if terms[name] is None else float(terms[name]) for name in names))
        return (force_chart(times, values), *(terms_chart(stage, history) for stage, history in found.items()))

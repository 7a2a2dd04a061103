"""A running reef mission on the live page: an observer that shows it and applies the page's pause, speed and stop."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np

from coral.reef.drive.controller import DdpMppi
from coral.reef.drive.cost_terms import COSTS
from coral.reef.mission.mission import Mission
from coral.view.live import reef_scene
from coral.view.live.history import History
from coral.view.live.pace import Pace
from coral.view.live.page import LivePage
from coral.view.live.state import Chart, LiveState
from coral.view.live.story import Story, told
from coral.view.pictures import RGB
from coral.view.questions import map_scene
from coral.view.run import Record

ROLLOUTS = 48
"""Number of the sampled rollouts that are drawn."""
COST_COLORS: tuple[RGB, ...] = (
    (214, 52, 44),
    (90, 90, 100),
    (0, 150, 170),
    (150, 120, 200),
    (255, 133, 0),
    (120, 170, 60),
)


class LiveMission:
    """Observes one mission without changing its random numbers or its simulated time."""

    def __init__(self, mission: Mission, page: LivePage, pace: Pace) -> None:
        self.page, self.pace = page, pace
        self.story = Story()
        self.history = History(("coverage", "commanded", "driven", *COSTS))
        self._truth = reef_scene.truth(mission.world)
        self._wall: tuple[float, float] | None = None
        self._factor = math.nan
        mission.listeners.append(self.hear)
        if isinstance(mission.driver, DdpMppi):
            # Not in the mission's configuration: watching a mission is not part of its definition.
            mission.driver.cfg = replace(mission.driver.cfg, keep_rollouts=True)
        page.show(LiveState(title=mission.world.name, about=self._about(mission), lines=self._truth))

    def hear(self, event: Record) -> None:
        """Handle one event of the mission."""
        self.story = told(self.story, event)

    def tick(self, mission: Mission) -> None:
        """Show a control tick if the page is ready, then wait as the page requires."""
        state, plan = mission.simulator.vehicle.state, mission.pilot.plan
        costs = plan.costs if plan is not None else {}
        command = plan.command[0] if plan is not None else math.nan
        self.history.add(
            mission.t, 100 * mission.coverage, command, float(state[3]), *(costs.get(name, math.nan) for name in COSTS)
        )
        if mission.end_reason or self.page.due():
            self.page.show(self.state(mission))
        if mission.end_reason:
            return
        began = time.monotonic()
        if self.pace.paused:
            self.page.show(self.state(mission))
        if self.pace.stand_still(lambda: self._meanwhile(mission)):
            mission.stood_still(time.monotonic() - began)
            self._wall = None
        self.pace.keep(mission.t)
        if self.pace.stop:
            self.story = replace(self.story, asked=None)
            self.page.show(self.state(mission, status=f"ended: {self.pace.stop}"))

    def stop_requested(self) -> str:
        """Return why the operator ended the mission, or ""."""
        return self.pace.stop

    def _meanwhile(self, mission: Mission) -> None:
        if self.page.due(only_new=True):
            self.page.show(self.state(mission))

    def state(self, mission: Mission, status: str = "") -> LiveState:
        """Return the present state of the mission."""
        belief, plan, story = mission.belief, mission.pilot.plan, self.story
        rollouts = plan.rollouts if plan is not None else None
        if rollouts is not None and plan is not None and plan.feasible is not None:
            rollouts = rollouts[plan.feasible][:: max(1, int(plan.feasible.sum()) // ROLLOUTS), :, :2]
        scene = replace(map_scene(belief), rollouts=rollouts, reference=mission.pilot.monitor.path)
        scene = replace(scene, trajectory=np.vstack([scene.trajectory, [belief.pose[:2]]]))
        speed = float(mission.simulator.vehicle.state[3])
        return LiveState(
            title=mission.world.name,
            about=self._about(mission),
            status=status or self._status(mission),
            t=mission.t,
            numbers=reef_scene.numbers(story, mission.coverage, speed),
            asked=story.asked,
            answered=story.answered,
            log=story.log,
            ground=reef_scene.ground(scene),
            lines=(*reef_scene.lines(scene, None if plan is None else plan.path), *self._truth),
            markers=reef_scene.markers(scene),
            bodies=reef_scene.robot(belief.pose),
            follow="robot",
            pictures=reef_scene.cameras(belief.frame),
            charts=self._charts(mission),
            legend=reef_scene.LEGEND + reef_scene.PLANNED,
        )

    def _status(self, mission: Mission) -> str:
        if mission.end_reason:
            return f"ended: {mission.end_reason}"
        if self.pace.paused:
            return "paused"
        now = time.monotonic()
        if self._wall is None:
            self._wall = now, mission.t
        elif now - self._wall[0] >= 1.0:
            self._factor = (mission.t - self._wall[1]) / (now - self._wall[0])
            self._wall = now, mission.t
        return "running" if math.isnan(self._factor) else f"running, {self._factor:.1f} × real time"

    def _charts(self, mission: Mission) -> tuple[Chart, ...]:
        def chart(
            title: str, names: tuple[str, ...], colors: tuple[RGB, ...], bounds: tuple[float, float] | None = None
        ) -> Chart:
            t, values = self.history.curves(names)
            return Chart(title=title, names=names, t=t, values=values, colors=colors, bounds=bounds)

        top = round(1.25 * mission.cfg.simulator.vehicle.max_speed_m_s, 1)
        charts = [
            chart("Coverage (%)", ("coverage",), ((11, 100, 112),), (0.0, 105.0)),
            chart("Forward speed (m/s)", ("commanded", "driven"), ((150, 160, 172), (25, 90, 230)), (-0.25 * top, top)),
        ]
        if isinstance(mission.driver, DdpMppi):
            charts.append(chart("Cost of the plan, by term", COSTS, COST_COLORS))
        return tuple(charts)

    @staticmethod
    def _about(mission: Mission) -> str:
        return f"advisor {mission.advisor.name}, variant {mission.variant}, seed {mission.seed}"

"""A survey in real time on the live page, with the operator's buttons; drawn off the control thread."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from coral.reef.map.belief import Belief
from coral.reef.sea.background import BackgroundWork
from coral.reef.sea.operator import OperatorWords, Word
from coral.reef.sea.sea_mission import SeaMission
from coral.reef.sea.survey_alignment import SurveyAlignment
from coral.view.live import reef_scene
from coral.view.live.page import LivePage
from coral.view.live.state import LiveState, Number
from coral.view.live.story import Story, told
from coral.view.questions import map_scene
from coral.view.run import Record

BUTTONS: tuple[tuple[Word, str, str, str, str], ...] = (
    ("arm", "Arm and begin", "player-play", "teal", "The thrusters start, and the survey begins."),
    ("hold", "Hold", "player-pause", "orange", "Stay here. Resume goes on."),
    ("resume", "Resume", "player-play", "teal", "Go on after a hold, a limit, or a person at the joystick."),
    ("surface", "End and surface", "arrow-up", "blue", "Ends the survey; the vehicle comes up where it is."),
    ("stop", "Stop the survey", "player-stop-filled", "red", "Ends the survey; the vehicle holds where it is."),
)
"""Word, label, icon, colour and hint of each button."""
RESUME_BUTTONS: tuple[tuple[Word, str, str, str, str], ...] = (
    ("align", "Use the alignment", "check", "teal", "Go on with the saved map, placed as proposed."),
    ("unaligned", "Go on without the saved map", "x", "gray", "Survey with the new map alone."),
)
"""Of a survey that looks for its place on a saved map."""


class SurveyControls:
    """The operator's buttons."""

    def __init__(self, words: OperatorWords, alignment: SurveyAlignment | None = None) -> None:
        """Set up; `alignment` is the search of a resumed survey for its place on the saved map."""
        self._words, self._alignment = words, alignment
        self._buttons: dict[Word, Any] = {}

    def build(self, gui: Any) -> None:
        """Add the buttons to the panel under construction."""
        for word, label, icon, color, hint in BUTTONS + (RESUME_BUTTONS if self._alignment is not None else ()):
            button = gui.add_button(label, icon=icon, color=color, hint=hint)
            button.on_click(lambda _, word=word: self._words.say(word, "page"))
            self._buttons[word] = button

    def show(self, state: LiveState) -> None:
        """Disable what has no meaning now: arming once under way, everything after the end."""
        ended, waiting = state.status.startswith("ended"), state.status.startswith("preflight")
        for word, button in self._buttons.items():
            disabled = ended or (word == "arm") != waiting
            if word in ("align", "unaligned"):
                disabled = disabled or not self._offers(word)
            if button.disabled != disabled:
                button.disabled = disabled

    def _offers(self, word: Word) -> bool:
        """Check whether the operator is asked about an alignment, or may give it up."""
        search = self._alignment
        return search is not None and not search.outcome and (word == "unaligned" or search.proposal is not None)


@dataclass(frozen=True, kw_only=True)
class Snapshot:
    """What the page shows, copied on the control thread: 2 ms on a map of 100 m. It is drawn on another one."""

    belief: Belief
    plan: Any
    reference: Any
    t: float
    coverage: float
    speed_m_s: float
    status: str
    battery: float | None
    story: Story
    note: str
    """What would end the vehicle's state, and what the operator is asked."""


class LiveSurvey:
    """Observes a survey; a page that is slow delays only itself."""

    def __init__(self, mission: SeaMission, page: LivePage, *, threaded: bool = True) -> None:
        self.page = page
        self._title, self._about = mission.area.name, f"advisor {mission.crew.advisor.name}"
        self._truth = reef_scene.truth(mission.crew.world)
        self._story = Story()
        self._work = BackgroundWork(2, threaded=threaded)
        mission.record.listeners.append(self.hear)

    def hear(self, event: Record) -> None:
        """Handle one event of the survey."""
        self._story = told(self._story, event)

    def waiting(self, lines: tuple[str, ...]) -> None:
        """Show the preflight list, newest line on top as in the log."""
        self.page.show(
            LiveState(title=self._title, about=self._about, status="preflight", log=lines, lines=self._truth)
        )

    def tick(self, mission: SeaMission) -> None:
        """Copy the state if the page is ready for it."""
        if not (mission.end_reason or self.page.due()):
            return
        plan, states = mission.pilot.plan, mission.states
        status = f"ended: {mission.end_reason}" if mission.end_reason else f"{states.state.value}"
        if states.reason and not mission.end_reason:
            status += f" - {states.reason}"
        velocity = mission.report.velocity
        snapshot = Snapshot(
            belief=mission.belief.snapshot(),
            plan=None if plan is None else plan.path,
            reference=mission.pilot.monitor.path,
            t=mission.t,
            coverage=mission.coverage,
            speed_m_s=velocity[0] if velocity is not None else float("nan"),
            status=status,
            battery=mission.report.battery_fraction,
            story=self._story,
            note=mission.notice,
        )
        self._work.offer(lambda: self.page.show(self.state(snapshot)))

    def stop_requested(self) -> str:
        """Return "": the page speaks through its buttons."""
        return ""

    def close(self) -> None:
        """Show what waits."""
        self._work.close()

    def state(self, now: Snapshot) -> LiveState:
        """Return the state of the page."""
        story, belief = now.story, now.belief
        scene = replace(map_scene(belief), reference=now.reference)
        scene = replace(scene, trajectory=np.vstack([scene.trajectory, [belief.pose[:2]]]))
        battery = () if now.battery is None else (Number(name="battery", value=f"{now.battery:.0%}"),)
        return LiveState(
            title=self._title,
            about=self._about,
            status=now.status,
            t=now.t,
            numbers=(*reef_scene.numbers(story, now.coverage, now.speed_m_s), *battery),
            asked=story.asked,
            answered=story.answered,
            log=story.log,
            ground=reef_scene.ground(scene),
            lines=(*reef_scene.lines(scene, now.plan), *self._truth),
            markers=reef_scene.markers(scene),
            bodies=reef_scene.robot(belief.pose),
            follow="robot",
            pictures=reef_scene.cameras(belief.frame),
            legend=reef_scene.LEGEND + reef_scene.PLANNED,
            note=now.note,
        )

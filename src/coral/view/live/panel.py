"""The side panels of the live page: numbers, decision, pictures, curves, and controls."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from coral.view.live import cards
from coral.view.live.pace import Pace
from coral.view.live.state import Chart, LiveState

SPEEDS = (1.0, 2.0, 5.0, 10.0, 20.0)
"""Available speeds, in multiples of real time."""
UNLIMITED = "as fast as possible"
CHART_PX = 100

LAYERS = (
    ("rollouts", "Rollouts", True, "Some of the futures that the controller tried at this moment."),
    ("shapes", "3D shapes", True, "Raise mapped obstacles and oysters. The map knows no heights; these are made up."),
    ("truth", "Show truth", False, "Outlines of the real oysters and obstacles, which the robot does not know."),
)


class PageControls(Protocol):
    """The buttons of one kind of page."""

    def build(self, gui: Any) -> None:
        """Add the buttons to the panel under construction."""
        ...

    def show(self, state: LiveState) -> None:
        """Update the buttons."""
        ...


class MissionControls:
    """Pause, stop and speed limit of what is running.

    Args:
        pace: The viewer's requests.
        stop: Label of the stop button.
        stop_now: Called by the stop button besides, at once and from its own thread.
    """

    def __init__(self, pace: Pace, stop: str = "Stop the mission", stop_now: Callable[[], None] | None = None) -> None:
        self.pace, self._label, self._stop_now = pace, stop, stop_now

    def build(self, gui: Any) -> None:
        """Add the buttons to the panel under construction."""
        self._pause = gui.add_button("Pause", icon="player-pause", color="teal")
        self._stop = gui.add_button(
            self._label, icon="player-stop-filled", color="red", hint="Ends it now; what was recorded is kept."
        )
        choices = {**speeds(self.pace.speed), UNLIMITED: 0.0}
        self._speed = gui.add_dropdown("Speed limit", tuple(choices), initial_value=named(self.pace.speed))
        self._pause.on_click(lambda _: self._toggle())
        self._stop.on_click(lambda _: self._end())
        self._speed.on_update(lambda _: setattr(self.pace, "speed", choices[self._speed.value]))

    def _end(self) -> None:
        if self._stop_now is not None:
            self._stop_now()
        self.pace.end()

    def _toggle(self) -> None:
        self.pace.paused = not self.pace.paused
        self._pause.label = "Resume" if self.pace.paused else "Pause"
        self._pause.icon = "player-play" if self.pace.paused else "player-pause"

    def show(self, state: LiveState) -> None:
        """Disable the buttons once the mission has ended."""
        if state.status.startswith("ended"):
            for handle in (self._pause, self._stop, self._speed):
                handle.disabled = True


class ReplayControls:
    """Time, play and speed of a recording."""

    def __init__(
        self, pace: Pace, duration_s: float, seek: Callable[[float], None], play: Callable[[bool], None]
    ) -> None:
        self.pace, self.duration_s, self.seek, self.play = pace, duration_s, seek, play

    def build(self, gui: Any) -> None:
        """Add the buttons to the panel under construction."""
        self._play = gui.add_button("Play", icon="player-play", color="teal")
        self._time = gui.add_slider("Time (s)", 0.0, max(self.duration_s, 0.1), 0.1, 0.0)
        choices = speeds(self.pace.speed)
        self._speed = gui.add_dropdown("Speed", tuple(choices), initial_value=named(self.pace.speed))
        self._play.on_click(lambda _: self.play(self.pace.paused))
        # The server also moves the slider, in which case there is no client.
        self._time.on_update(lambda event: event.client is not None and self.seek(float(self._time.value)))
        self._speed.on_update(lambda _: setattr(self.pace, "speed", choices[self._speed.value]))

    def show(self, state: LiveState) -> None:
        """Move the slider along with the recording."""
        self._time.value = round(min(max(state.t, 0.0), max(self.duration_s, 0.1)), 1)
        paused = self.pace.paused
        if (self._play.label == "Play") != paused:
            self._play.label = "Play" if paused else "Pause"
            self._play.icon = "player-play" if paused else "player-pause"


class LivePanel:
    """Two columns beside the scene: the mission on the right, its sensors and curves on the left."""

    def __init__(
        self, server: Any, controls: PageControls, hide: Callable[[str, bool], None], follow: Callable[[bool], None]
    ) -> None:
        gui = self._gui = server.gui
        self._controls = controls
        self._charts: dict[str, Any] = {}
        self._pictures: dict[str, Any] = {}
        gui.configure_theme(dark_mode=False, show_logo=False, show_share_button=False, brand_color=(11, 100, 112))
        gui.main_panel.dock_right()
        gui.main_panel.set_width(340)
        self._head = gui.add_html("")
        controls.build(gui)
        self._decision = gui.add_html("")
        with gui.add_folder("What happened"):
            self._log = gui.add_html("")
        with gui.add_folder("View"):
            for layer, name, shown, hint in LAYERS:
                box = gui.add_checkbox(name, shown, hint=hint)
                box.on_update(lambda event, layer=layer: hide(layer, not event.target.value))
            following = gui.add_checkbox("Follow robot", False, hint="Keep the robot in the middle of the picture.")
            following.on_update(lambda event: follow(bool(event.target.value)))
            self._legend = gui.add_html("")
        side = gui.add_panel()
        self._eyes = side.add_tab("Sensors and curves")
        side.dock_left()
        side.set_width(256)

    def show(self, state: LiveState) -> None:
        """Update every element; unchanged ones are not sent."""
        for handle, content in (
            (self._head, cards.head(state)),
            (self._decision, cards.decision(state)),
            (self._log, cards.log(state)),
            (self._legend, cards.legend(state)),
        ):
            if handle.content != content:
                handle.content = content
        with self._eyes:
            for name, rgb in state.pictures:
                if name in self._pictures:
                    self._pictures[name].image = rgb
                else:
                    self._pictures[name] = self._gui.add_image(rgb, label=name, format="png")
            for chart in state.charts:
                self._show_chart(chart, state.curves_s or state.until_s)
        self._controls.show(state)

    def _show_chart(self, chart: Chart, until_s: float) -> None:
        if not len(chart.t):
            return
        data = (chart.t, *chart.values)
        right = max(until_s, float(chart.t[-1]), 1.0)
        scales: dict[str, Any] = {"x": {"time": False, "range": (0.0, right)}}
        if chart.bounds is not None:
            scales["y"] = {"range": chart.bounds}
        if chart.title in self._charts:
            handle = self._charts[chart.title]
            handle.data = data
            handle.scales = scales
            return
        series = [
            {"label": "t (s)"},
            *(
                {"label": name, "stroke": f"rgb{color}", "width": 2, "spanGaps": False}
                for name, color in zip(chart.names, chart.colors, strict=True)
            ),
        ]
        self._charts[chart.title] = self._gui.add_uplot(
            data,
            tuple(series),
            title=chart.title,
            scales=scales,
            height=CHART_PX,
            legend={"show": False},
            cursor={"show": False},
            padding=(4, 12, 0, 0),
            axes=({"size": 24, "space": 50}, {"size": 40, "space": 26}),
        )
        if len(chart.names) > 1:
            self._gui.add_html(cards.keys(zip(chart.colors, chart.names, strict=True)))


def named(speed: float) -> str:
    """Format a speed limit; 0 is none."""
    return UNLIMITED if speed <= 0 else "real time" if speed == 1 else f"{speed:g} × real time"


def speeds(begun_with: float) -> dict[str, float]:
    """Return names and values of the available speeds, including the initial one."""
    return {named(speed): speed for speed in sorted({*SPEEDS, begun_with} - {0.0})}

"""The buttons of a contact task's page: pause, stop, speed, and a slider for the weight of each term."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from typing import Any

from coral.contact.control.term_weights import TermWeights
from coral.view.live.pace import Pace
from coral.view.live.panel import MissionControls
from coral.view.live.state import LiveState

MOST = 4.0
"""Largest factor on a term."""


class TaskControls:
    """Pause, stop, speed, and factors on the cost's terms that act from the next plan on.

    Args:
        pace: The viewer's requests.
        weights: The episode's factors; None for an episode without them.
        stop_now: Called by the stop button besides, at once and from its own thread: it stops an arm.
    """

    def __init__(self, pace: Pace, weights: TermWeights | None, stop_now: Callable[[], None] | None = None) -> None:
        self.pace, self.weights, self._stop_now = pace, weights, stop_now
        self._run = MissionControls(pace, "Stop the task", stop_now)
        self._lock = threading.Lock()
        self._terms: dict[tuple[str, str], None] = {}
        self._sliders: dict[tuple[str, str], Any] = {}
        self._folders: dict[str, Any] = {}

    def offer(self, stage: str, terms: Iterable[str]) -> None:
        """Give each of these terms a slider, unless it has one."""
        with self._lock:
            self._terms |= {(stage, term): None for term in terms}

    def build(self, gui: Any) -> None:
        """Add the buttons to the panel under construction."""
        self._gui = gui
        self._run.build(gui)
        self._weights = gui.add_folder("Weights of the cost", visible=self.weights is not None)

    def show(self, state: LiveState) -> None:
        """Add the sliders of new terms; disable everything once the task has ended."""
        self._run.show(state)
        if self.weights is None:
            return
        with self._lock:
            new = [key for key in self._terms if key not in self._sliders]
        for stage, term in new:
            self._add(stage, term)
        if state.status.startswith("ended"):
            for slider in self._sliders.values():
                slider.disabled = True

    def _add(self, stage: str, term: str) -> None:
        weights = self.weights
        assert weights is not None
        with self._weights:
            if stage not in self._folders:
                self._folders[stage] = self._gui.add_folder(f"stage {stage}", expand_by_default=not self._folders)
            with self._folders[stage]:
                slider = self._gui.add_slider(
                    term, 0.0, MOST, 0.1, 1.0, hint="Factor on this term of the cost; 1 is the strategy's own weight."
                )
        slider.on_update(lambda event: weights.set(stage, term, float(event.target.value)))
        self._sliders[stage, term] = slider

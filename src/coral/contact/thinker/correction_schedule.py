"""Schedule of world-model corrections without a failure: at intervals in which an object was touched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from coral.contact.scene.observation import Transition
from coral.contact.world_model.history import most_informative_object


@dataclass
class CorrectionSchedule:
    """Decides when to correct and for which object, and counts the corrections of an episode."""

    every_s: float
    """Simulated time between two corrections; 0 disables them."""
    most: int
    """Maximum number per episode. One is kept for the end: objects are lifted last, and that reveals their weight."""
    done: int = 0
    _since: float = 0.0
    _seen: int = 0

    def due(self, steps: Sequence[Transition], last: bool = False) -> str | None:
        """Return the object to correct now, or None."""
        if not self.every_s or not steps or self.done >= self.most - (not last):
            return None
        now = steps[-1].after.time_s
        if now - self._since < self.every_s - 1e-9 and not last:
            return None
        name = most_informative_object(steps[self._seen :])
        if name is not None:
            self.done, self._since, self._seen = self.done + 1, now, len(steps)
        return name

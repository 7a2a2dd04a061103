"""Whether an episode has succeeded or can no longer succeed, by the world as it is."""

from __future__ import annotations

from coral.contact.draw import Drawn
from coral.contact.geometry import rotate
from coral.contact.world import Truth

BELOW_TABLE_M = 0.03
"""An object this far below the table's top has left the table or passed through it."""


class Judge:
    """Watches one episode.

    Args:
        drawn: The trial.
    """

    def __init__(self, drawn: Drawn) -> None:
        self._drawn = drawn
        self._success = drawn.task.success
        self._watches = [condition.watch(drawn) for condition in self._success.conditions]
        # An object's own origin may lie anywhere, as at its foot.
        corners = {name: drawn.corners(name) for name in drawn.objects}
        self._middle = {name: (found.min(axis=0) + found.max(axis=0)) / 2 for name, found in corners.items()}
        self._since: float | None = None
        self.holding: tuple[bool, ...] = ()

    def success(self, truth: Truth) -> bool:
        """Whether all conditions have held long enough; to be shown every control step."""
        self.holding = tuple(watch(truth) for watch in self._watches)
        if not all(self.holding):
            self._since = None
            return False
        if self._since is None:
            self._since = truth.time_s
        return truth.time_s - self._since >= self._success.hold_s - 1e-9

    def failure(self, truth: Truth) -> str | None:
        """Name of what can no longer be mended, or None."""
        table = self._drawn.task.table
        for name, body in truth.objects.items():
            if self._drawn.lowest_point(name, body) > -BELOW_TABLE_M:
                continue
            middle = body.position + rotate(body.quaternion, self._middle[name])
            over_table = all(abs(middle[k] - table.center[k]) < table.size[k] / 2 for k in (0, 1))
            if over_table and middle[2] < 0:
                return f"tunnelling: {name}"
            if middle[2] < -BELOW_TABLE_M - 0.1:
                return f"dropped: {name}"
        return None

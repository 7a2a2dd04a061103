"""A resumed survey looks for its place on the saved map, off the control thread, and asks the operator."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.config import Positive
from coral.reef.map.belief import Belief
from coral.reef.sea.background import BackgroundWork
from coral.reef.sea.known_ground import KnownGround
from coral.reef.sea.local_frame import LocalFrame, shift_points
from coral.reef.sea.map_alignment import AlignmentCfg, MapAlignment, align_maps
from coral.reef.sea.map_merge import merge_maps
from coral.reef.sea.operator import Word
from coral.reef.world.geometry import Pose


@dataclass(frozen=True, kw_only=True)
class ResumeCfg:
    """How a resumed survey finds its place on the saved map."""

    period_s: Positive = 3.0
    """Time between attempts, while nothing has been found."""
    patience_s: Positive = 120.0
    """Without a match, or without the operator's word about one, the survey continues with its new map alone after
    this time."""
    alignment: AlignmentCfg = field(default_factory=AlignmentCfg)


@dataclass(frozen=True, kw_only=True)
class SavedMap:
    """An earlier survey whose map is to be found again."""

    belief: Belief
    """What it knew. It becomes the merged one."""
    confirmed: bool = False
    """Take an alignment without the operator's word; for rehearsals."""
    cfg: ResumeCfg = field(default_factory=ResumeCfg)


class SurveyAlignment:
    """Matches the new map with the saved one, proposes, and makes one map of both on the operator's word.

    Called once per tick; nothing is computed in the caller's thread but copies of the map.
    """

    def __init__(
        self,
        saved: SavedMap,
        start: Pose,
        forbidden: NDArray[np.bool_],
        tell: Callable[..., None],
        *,
        threaded: bool = True,
    ) -> None:
        """Set up.

        Args:
            saved: The earlier survey.
            start: Where the operator said that the vehicle was put in.
            forbidden: Cells outside the fence or inside keep-outs. Shape=(NY, NX).
            tell: tell(event, **fields) records an event.
            threaded: False for tests: then the caller's thread computes.
        """
        self.cfg, self._saved, self._start, self._forbidden = saved.cfg, saved.belief, start, forbidden
        self._tell, self._confirmed = tell, saved.confirmed
        self._ground: KnownGround | None = None
        self._work = BackgroundWork(2, threaded=threaded)
        self._threaded = threaded
        self._lock = threading.Lock()
        self._found: MapAlignment | None = None
        self._merged: tuple[Belief, LocalFrame] | None = None
        self._busy = self._merging = False
        self._tried_s, self._since_s, self._reason = float("-inf"), 0.0, "nothing has been compared yet"
        self.proposal: MapAlignment | None = None
        """What the operator is asked about."""
        self.outcome = ""
        """aligned, or why the survey continues without the saved map; "" while that is open."""

    @property
    def status(self) -> str:
        """What is going on, in words for the operator; "" when it is decided."""
        if self.outcome:
            return ""
        if self.proposal is not None:
            return f"alignment with the saved map: {self.proposal}. Use it, or go on without?"
        return f"looking for its place on the saved map: {self._reason}"

    def say(self, word: Word, source: str) -> None:
        """Take the operator's word: `align` or `unaligned`; others are not for the alignment."""
        if self.outcome or self._merging:
            return
        if word == "unaligned":
            self._end(f"refused by the operator ({source})")
        elif word == "align" and self.proposal is not None:
            self._confirmed = True

    def update(self, t: float, belief: Belief) -> tuple[Belief, LocalFrame] | None:
        """Continue the search. Return the merged belief and the shift to its frame, once."""
        if self.outcome:
            return None
        self._hear(t)
        if self._merged is not None:
            self.outcome = "aligned"
            self._tell_alignment("used", self.proposal)
            return self._merged
        if self._merging:
            return None
        if self.proposal is not None and self._confirmed:
            self._merge(belief)
        elif t >= self._since_s + self.cfg.patience_s:
            self._end("no word from the operator" if self.proposal is not None else self._reason)
        elif self.proposal is None and not self._busy and t >= self._tried_s + self.cfg.period_s:
            self._tried_s = t
            self._match(belief)
        return None

    def close(self) -> None:
        """End the work."""
        self._work.close()

    def _match(self, belief: Belief) -> None:
        cells = belief.map.snapshot()

        def work() -> None:
            new = KnownGround.of_map(cells, self._forbidden)
            if self._ground is None:
                self._ground = KnownGround.of_map(self._saved.map, self._forbidden)
            found = align_maps(self._ground, new, self._start, self.cfg.alignment)
            with self._lock:
                self._found = found

        self._busy = True
        self._do(work)

    def _merge(self, belief: Belief) -> None:
        assert self.proposal is not None
        shift, memory, trail, pose = self.proposal.shift, belief.map.memory(), belief.trajectory, belief.pose
        saved, forbidden = self._saved, self._forbidden

        def work() -> None:
            cells = saved.map
            cells.recall(merge_maps(cells.memory(), memory, shift, cells.cfg.cell_m, forbidden))
            saved.recall(saved.tracks, np.concatenate([saved.trajectory, shift_points(shift, trail)]))
            saved.pose = shift.to_survey(pose)
            with self._lock:
                self._merged = saved, shift

        self._merging = True
        self._do(work)

    def _do(self, work: Callable[[], None]) -> None:
        self._work.offer(work)
        if not self._threaded:
            self._work.drain()

    def _hear(self, t: float) -> None:
        """Take over what the thread has found."""
        with self._lock:
            found, self._found = self._found, None
        if self._work.failure:
            self._end(f"the alignment failed: {self._work.failure}")
            return
        if found is None:
            return
        self._busy = False
        if found.refusal:
            if found.refusal.partition(":")[0] != self._reason.partition(":")[0]:
                self._tell_alignment("none yet", found, reason=found.refusal)
            self._reason = found.refusal
        else:
            self.proposal, self._since_s = found, t
            self._tell_alignment("proposed", found)

    def _end(self, reason: str) -> None:
        self.outcome = reason
        self._tell_alignment("unaligned", self.proposal, reason=reason)

    def _tell_alignment(self, status: str, found: MapAlignment | None, **fields: Any) -> None:
        """Record an event with the evidence."""
        evidence: dict[str, Any] = {}
        if found is not None:
            evidence = {
                "moved_m": round(found.moved_m, 3),
                "turned_deg": round(found.turned_deg, 2),
                "bodies": found.bodies,
                "matched": found.matched,
                "residual_m": round(found.residual_m, 3) if found.matched else None,
                "score": round(found.score, 1),
                "second": round(found.second, 1),
            }
        self._tell("alignment", status=status, **fields, **evidence)

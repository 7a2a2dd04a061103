"""What the robot knows when it asks, and what it will have done when the answer is needed: a value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.reef.decide.guesses import GuessRecord
from coral.reef.decide.route import Arrival, here
from coral.reef.map.belief import Belief
from coral.reef.map.chain import Track
from coral.reef.world.geometry import to_robot


@dataclass(frozen=True)
class Outlook:
    """A frozen state to make a question from."""

    belief: Belief
    """A snapshot: it stays as it is while the robot moves on."""
    arrival: Arrival
    closed: frozenset[int] = frozenset()
    """Labels of the clusters that will be done by then, whatever is answered."""
    last_look: bool = False
    """Whether doubtful clusters are goals too: nothing else is left."""
    under_way: bool = False
    """Whether it is on its way to a goal."""
    colours: bool = False
    """Whether the question shows colour pictures of what was seen: for missions in words."""
    alone: bool = False
    """Whether the advisor has left what is unexplored to the robot's own tour."""
    latency_s: float = 0.0
    """How long the answer is expected to take (s)."""
    guesses: GuessRecord = field(default_factory=GuessRecord)
    """How the advisor's guesses have come out."""
    idle: NDArray[np.bool_] | None = None
    """Unexplored cells that are not worth a visit, Shape=(NY, NX); None: not told apart, as in the paper."""
    advice: Mapping[str, Any] | None = None
    """What the robot's own tour says of the last choice."""

    @classmethod
    def now(cls, belief: Belief) -> Outlook:
        """Return the outlook of a robot that is where it is going."""
        return cls(belief, here(belief))

    def done(self, track: Track) -> bool:
        """Check whether nothing is left to see of a cluster, now or on arrival."""
        return track.visited or track.index in self.closed

    def unvisited(self) -> list[Track]:
        """Return the clusters still to be visited on arrival."""
        return [t for t in self.belief.unvisited(doubtful=self.last_look) if t.index not in self.closed]

    def ahead(self, forward_m: float) -> list[Track]:
        """Return unvisited clusters with a forward projection of at least `forward_m` on arrival."""
        return [t for t in self.unvisited() if to_robot(self.arrival.pose, t.x, t.y)[0] >= forward_m]

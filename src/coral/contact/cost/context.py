"""Inputs of a cost function: named quantities over a batch of rolled-out states.

Every value is an array whose first two axes are rollout and time step: Shape=(K, H) for a number or a truth value,
Shape=(K, H, n) for a vector. A quantity that is constant in a rollout has K = H = 1 and broadcasts. Frames: world,
metres, z up, the table's top at z = 0. Quaternions are (w, x, y, z).

The names are the same in expert costs, in programs written by a model and on the reference page.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Terms = dict[str, Array]
"""Named terms of a running cost, each broadcastable to Shape=(K, H); the cost of a state is their sum."""


@dataclass(frozen=True)
class Quantity:
    """Description of one name that a cost may read."""

    size: int
    """0 for a number per state, n for a vector of n."""
    unit: str
    """SI unit, or "" without one."""
    text: str
    """Description, with the frame."""
    truth: bool = False
    """Whether it is a truth value (0 or 1 in the array)."""
    constant: bool = False
    """Whether it is constant during a rollout."""


Schema = Mapping[str, Quantity]


@dataclass(frozen=True, eq=False)
class Derived:
    """A quantity that follows from others of the same state, so that it is right in a state that was changed, too."""

    compute: Callable[[Context], Array]
    """Function of a batch of states, Shape=(K, H) or (1, 1)."""


Value = Array | Derived


class Lazy(Mapping[str, Value]):
    """Values, some of them computed at first access: a cost reads only a few of the available names."""

    def __init__(self, makers: Mapping[str, Callable[[], Value] | Value]) -> None:
        self._makers = makers
        self._made: dict[str, Value] = {}

    def __getitem__(self, name: str) -> Value:
        if name not in self._made:
            made = self._makers[name]
            self._made[name] = made() if callable(made) else made
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in self._makers

    def __iter__(self) -> Iterator[str]:
        return iter(self._makers)

    def __len__(self) -> int:
        return len(self._makers)


class Context:
    """A batch of states with named quantities; `state.box_pos` reads one."""

    def __init__(self, values: Mapping[str, Value], shape: tuple[int, int]) -> None:
        self._values = values
        self._derived: dict[str, Array] = {}
        self.shape = shape

    def __getattr__(self, name: str) -> Array:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(name) from None

    def __getitem__(self, name: str) -> Array:
        value = self._values[name]
        if not isinstance(value, Derived):
            return value
        if name not in self._derived:
            self._derived[name] = value.compute(self)
        return self._derived[name]

    def source(self, name: str) -> Value:
        """Return a value for another batch: one that is derived stays so, and follows that batch."""
        return self._values[name]

    def __contains__(self, name: object) -> bool:
        return name in self._values

    def names(self) -> list[str]:
        """Return all names."""
        return sorted(self._values)

    def first(self) -> Context:
        """Return the first state of the first sequence, as a batch of one."""
        return Context(Lazy({name: partial(self._first_value, name) for name in self._values}), (1, 1))

    def _first_value(self, name: str) -> Value:
        value = self._values[name]
        return value if isinstance(value, Derived) else value[:1, :1]


class Cost(Protocol):
    """A running cost over a batch of states (Eq. 5), as named terms."""

    name: str

    def __call__(self, state: Context) -> Terms:
        """Compute the terms of every state.

        Raises:
            CostError: The cost cannot be evaluated on this state.
        """


@runtime_checkable
class ReadingCost(Protocol):
    """A cost that declares which quantities it reads."""

    reads: list[str]
    """Their names."""

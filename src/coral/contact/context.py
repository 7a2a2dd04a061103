"""What a cost function may read: named quantities over a batch of rolled-out states.

Every value is an array whose first two axes are rollout and time step, Shape=(K, H) for a number or a truth value and
(K, H, n) for a vector; a quantity that does not change in a rollout has K = H = 1 and broadcasts. Frames: world,
metres, z up, the table's top at z = 0. Quaternions are (w, x, y, z).

The names are the same for expert costs, for programs that a model writes and for the reference page.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Terms = dict[str, Array]
"""Named terms of a running cost, each broadcastable to Shape=(K, H); the cost of a state is their sum."""


@dataclass(frozen=True)
class Quantity:
    """One name that a cost may read.

    Args:
        size: 0 for a number per state, n for a vector of n.
        unit: SI unit, or "" where there is none.
        text: What it is, in which frame.
        truth: Whether it is a yes or no (0 or 1 in the array).
        constant: Whether it stays the same during a rollout.
    """

    size: int
    unit: str
    text: str
    truth: bool = False
    constant: bool = False


Schema = Mapping[str, Quantity]

HAND: Schema = {
    "ee_pos": Quantity(3, "m", "point midway between the two fingertips"),
    "ee_quat": Quantity(
        4, "", "orientation of the hand; its z axis points out of the palm, its y axis along the fingers' opening"
    ),
    "ee_vel": Quantity(3, "m/s", "velocity of ee_pos"),
    "ee_angvel": Quantity(3, "rad/s", "angular velocity of the hand, world axes"),
    "gripper_opening": Quantity(0, "m", "distance between the finger pads, 0 to 0.08"),
    "gripper_target": Quantity(0, "m", "commanded distance between the finger pads; below gripper_opening it squeezes"),
    "ee_force": Quantity(3, "N", "force that everything touched exerts on the hand, world axes"),
    "ee_torque": Quantity(3, "N m", "torque that everything touched exerts on the hand about ee_pos, world axes"),
    "time": Quantity(0, "s", "time since the episode began"),
    "current_step": Quantity(0, "", "control steps since the episode began"),
    "last_action": Quantity(
        7, "", "what is commanded over this step: hand velocity (m/s), angular velocity (rad/s), opening speed (m/s)"
    ),
}


def object_quantities(
    name: str, points: Iterable[str] = (), fixtures: Iterable[str] = (), others: Iterable[str] = ()
) -> dict[str, Quantity]:
    """The quantities of one movable object.

    Args:
        name: Its name in the task.
        points: Named points on it, as `handle` on a board.
        fixtures: Things that do not move and that it may touch, as `table` and `wall`.
        others: Other movable objects that it may touch.
    """
    found = {
        f"{name}_pos": Quantity(3, "m", f"origin of the {name}'s frame: its middle, unless its parts lie elsewhere"),
        f"{name}_quat": Quantity(4, "", f"orientation of the {name}"),
        f"{name}_vel": Quantity(3, "m/s", f"velocity of the {name}"),
        f"{name}_angvel": Quantity(3, "rad/s", f"angular velocity of the {name}, world axes"),
        f"{name}_init_pos": Quantity(3, "m", f"{name}_pos when the episode began", constant=True),
        f"{name}_init_quat": Quantity(4, "", f"{name}_quat when the episode began", constant=True),
        f"{name}_size": Quantity(3, "m", f"full extents of the {name} along its own axes", constant=True),
        f"{name}_mass": Quantity(0, "kg", f"believed mass of the {name}", constant=True),
        f"{name}_friction": Quantity(0, "", f"believed friction coefficient of the {name}", constant=True),
        f"{name}_hand_force": Quantity(3, "N", f"net contact force of the hand on the {name}, world axes"),
        f"{name}_hand_contact": Quantity(0, "", f"whether the hand touches the {name}", truth=True),
        f"{name}_left_contact": Quantity(0, "", f"whether the left finger touches the {name}", truth=True),
        f"{name}_right_contact": Quantity(0, "", f"whether the right finger touches the {name}", truth=True),
    }
    for point in points:
        found[f"{name}_{point}_pos"] = Quantity(3, "m", f"the {point} of the {name}")
    for thing in (*fixtures, *others):
        found[f"{name}_{thing}_contact"] = Quantity(0, "", f"whether the {name} touches the {thing}", truth=True)
    return found


def scenery_quantities(
    fixtures: Iterable[str] = (), places: Iterable[str] = (), numbers: Iterable[str] = ()
) -> dict[str, Quantity]:
    """The quantities of what stays where it is: the table, fixtures, and places and numbers of the task file."""
    found = {
        "table_min": Quantity(3, "m", "corner of the table with the smallest coordinates", constant=True),
        "table_max": Quantity(3, "m", "corner of the table with the largest coordinates", constant=True),
    }
    for name in fixtures:
        found[f"{name}_pos"] = Quantity(3, "m", f"centre of the {name}", constant=True)
        found[f"{name}_size"] = Quantity(3, "m", f"full extents of the {name}", constant=True)
    for name in places:
        found[f"{name}_pos"] = Quantity(3, "m", f"the place {name} of the task", constant=True)
    for name in numbers:
        found[name] = Quantity(0, "", f"the number {name} of the task", constant=True)
    return found


class Lazy(Mapping[str, Array]):
    """Values that are made when they are first read: a cost reads a few of the dozens of names that it may."""

    def __init__(self, makers: Mapping[str, Callable[[], Array]]) -> None:
        self._makers = makers
        self._made: dict[str, Array] = {}

    def __getitem__(self, name: str) -> Array:
        if name not in self._made:
            self._made[name] = self._makers[name]()
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in self._makers

    def __iter__(self) -> Iterator[str]:
        return iter(self._makers)

    def __len__(self) -> int:
        return len(self._makers)


class Context:
    """A batch of states under their names; `state.box_pos` reads one."""

    def __init__(self, values: Mapping[str, Array], shape: tuple[int, int]) -> None:
        self._values = values
        self.shape = shape

    def __getattr__(self, name: str) -> Array:
        try:
            return self._values[name]
        except KeyError:
            raise AttributeError(name) from None

    def __getitem__(self, name: str) -> Array:
        return self._values[name]

    def __contains__(self, name: object) -> bool:
        return name in self._values

    def names(self) -> list[str]:
        """Everything that can be read."""
        return sorted(self._values)

    def first(self) -> Context:
        """The first state of the first sequence, as a batch of one."""
        return Context(Lazy({name: partial(self._corner, name) for name in self._values}), (1, 1))

    def _corner(self, name: str) -> Array:
        return self._values[name][:1, :1]


class Cost(Protocol):
    """A running cost over a batch of states (Eq. 5), as named terms."""

    name: str

    def __call__(self, state: Context) -> Terms:
        """The terms of every state.

        Raises:
            CostError: The cost cannot be evaluated on this state.
        """
        ...


Gains = Literal["stiff", "soft"]

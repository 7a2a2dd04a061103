"""The PyBullet functions that the paper's costs call, computed from the state. Quaternions are (x, y, z, w) here."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.quaternions import (
    Quat,
    difference,
    euler,
    matrix,
    read_quat,
    write_quat,
)
from coral.contact.cost_program.sharing import renewed
from coral.contact.cost_program.state import StateSpace
from coral.contact.cost_program.values import BodyHandle, ContactList, Seq, Value, Vec, kind

IGNORED = ("physicsClientId", "computeForwardKinematics", "computeLinkVelocity")


class PyBullet:
    """The module `p`: PyBullet calls by name."""

    def __init__(self, space: StateSpace) -> None:
        self.space = space
        self.calls: dict[str, Callable[[Meter, list[Value]], Value]] = {
            "getLinkState": self._link_state,
            "getBasePositionAndOrientation": self._base_pose,
            "getBaseVelocity": self._base_velocity,
            "getContactPoints": self._contacts,
            "getDifferenceQuaternion": _difference,
            "getEulerFromQuaternion": _euler,
            "getMatrixFromQuaternion": _matrix,
        }

    def __call__(self, meter: Meter, name: str, args: list[Value], named: dict[str, Value]) -> Value:
        """Answer `p.name(...)`.

        Raises:
            CostError: The arguments do not fit.
        """
        given = [*args, *(value for key, value in named.items() if key not in IGNORED)]
        return self.calls[name](meter, given)

    def _fresh(self, meter: Meter, name: str) -> Value:
        """Return a copy of a quantity, which shares no memory with the state."""
        return renewed(self.space.read(meter, name))

    def _link_state(self, meter: Meter, args: list[Value]) -> Value:
        self._body(meter, args[:1], "hand")
        position, velocity = self._fresh(meter, "ee_pos"), self._fresh(meter, "ee_vel")
        orientation, spin = self._fresh(meter, "ee_ori"), self._fresh(meter, "ee_angvel")
        offset, none = Vec((0.0, 0.0, 0.0)), Vec((0.0, 0.0, 0.0, 1.0), order="xyzw")
        return Seq((position, orientation, offset, none, position, orientation, velocity, spin), "tuple")

    def _base_pose(self, meter: Meter, args: list[Value]) -> Value:
        name = self._body(meter, args, "object")
        return Seq((self._fresh(meter, f"{name}_pos"), self._fresh(meter, f"{name}_ori")), "tuple")

    def _base_velocity(self, meter: Meter, args: list[Value]) -> Value:
        name = self._body(meter, args, "object")
        return Seq((self._fresh(meter, f"{name}_vel"), self._fresh(meter, f"{name}_angvel")), "tuple")

    def _contacts(self, meter: Meter, args: list[Value]) -> Value:
        bodies = [item for item in args if isinstance(item, BodyHandle) and item.name != "other"]
        if len(bodies) != 2:
            raise meter.fault("wrong_call", "getContactPoints is answered for two bodies, as (self.panda, self.box)")
        names = [body.name for body in bodies]
        for thing, other in (names, names[::-1]):
            if f"{thing}_{other}_contact" in self.space.schema:
                touching = self.space.read(meter, f"{thing}_{other}_contact")
                assert isinstance(touching, np.ndarray)
                return ContactList(touching.astype(np.bool_))
        known = [name for name in self.space.available() if name.endswith("_contact")]
        raise meter.fault(
            "unknown_state", f"contact of {names[0]} and {names[1]} is not in the state; it has {', '.join(known)}"
        )

    def _body(self, meter: Meter, args: list[Value], what: str) -> str:
        body = args[0] if args else None
        if not isinstance(body, BodyHandle):
            raise meter.fault("wrong_call", f"the first argument must be a body as self.{what}, not {kind(body)}")
        if (what == "hand") != (body.name == "hand") or (what == "object" and body.name not in self.space.objects):
            choice = "self.panda" if what == "hand" else ", ".join(f"self.{name}" for name in self.space.objects)
            raise meter.fault("wrong_call", f"this function is answered for {choice} only")
        return body.name


def _quats(meter: Meter, args: list[Value], count: int) -> list[Quat]:
    if len(args) != count:
        raise meter.fault("wrong_call", f"this function takes {count} quaternions, not {len(args)} arguments")
    return [read_quat(meter, value, "xyzw") for value in args]


def _difference(meter: Meter, args: list[Value]) -> Value:
    start, end = _quats(meter, args, 2)
    return write_quat(difference(meter, start, end), "xyzw")


def _euler(meter: Meter, args: list[Value]) -> Value:
    return euler(meter, _quats(meter, args, 1)[0])


def _matrix(meter: Meter, args: list[Value]) -> Value:
    rows = matrix(meter, _quats(meter, args, 1)[0])
    return Vec(tuple(item for row in rows for item in row))

"""The PyBullet functions that the paper's costs call, computed from the state. Quaternions are (x, y, z, w) here."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from coral.contact.cost_program.arithmetic import binary, components, negative
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.quaternions import (
    Quat,
    conjugate,
    difference,
    euler,
    from_euler,
    matrix,
    product,
    read_quat,
    rotate,
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
            "getQuaternionFromEuler": _from_euler,
            "getMatrixFromQuaternion": _matrix,
            "rotateVector": _rotate,
            "invertTransform": _invert,
            "multiplyTransforms": _multiply,
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


def _three(meter: Meter, value: Value) -> tuple[Value, ...]:
    items = components(meter, value)
    if len(items) != 3:
        raise meter.fault("wrong_size", f"a vector of 3 is needed here, not of {len(items)}")
    return items


def _arguments(meter: Meter, args: list[Value], count: int) -> list[Value]:
    if len(args) != count:
        raise meter.fault("wrong_call", f"this function takes {count} arguments, not {len(args)}")
    return args


def _difference(meter: Meter, args: list[Value]) -> Value:
    start, end = _quats(meter, args, 2)
    return write_quat(difference(meter, start, end), "xyzw")


def _euler(meter: Meter, args: list[Value]) -> Value:
    return euler(meter, _quats(meter, args, 1)[0])


def _from_euler(meter: Meter, args: list[Value]) -> Value:
    return write_quat(from_euler(meter, _three(meter, _arguments(meter, args, 1)[0])), "xyzw")


def _matrix(meter: Meter, args: list[Value]) -> Value:
    rows = matrix(meter, _quats(meter, args, 1)[0])
    return Vec(tuple(item for row in rows for item in row))


def _rotate(meter: Meter, args: list[Value]) -> Value:
    quat, vector = _arguments(meter, args, 2)
    return rotate(meter, read_quat(meter, quat, "xyzw"), _three(meter, vector))


def _invert(meter: Meter, args: list[Value]) -> Value:
    position, orientation = _arguments(meter, args, 2)
    back = conjugate(meter, read_quat(meter, orientation, "xyzw"))
    turned = rotate(meter, back, _three(meter, position))
    return Seq((negative(meter, turned), write_quat(back, "xyzw")), "tuple")


def _multiply(meter: Meter, args: list[Value]) -> Value:
    position_a, quat_a, position_b, quat_b = _arguments(meter, args, 4)
    a, b = read_quat(meter, quat_a, "xyzw"), read_quat(meter, quat_b, "xyzw")
    turned = rotate(meter, a, _three(meter, position_b))
    position = binary(meter, "+", Vec(_three(meter, position_a)), turned)
    return Seq((position, write_quat(product(meter, a, b), "xyzw")), "tuple")

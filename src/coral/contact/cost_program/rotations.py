"""SciPy's Rotation: the subset that costs use. Its quaternions are (x, y, z, w)."""

from __future__ import annotations

from collections.abc import Callable

from coral.contact.cost_program.arithmetic import as_vector, components, number, root, scalar, total
from coral.contact.cost_program.functions import of_one, of_two, select
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.quaternions import (
    Quat,
    conjugate,
    euler,
    from_euler,
    matrix,
    normalised,
    product,
    read_quat,
    rotate,
    write_quat,
)
from coral.contact.cost_program.values import NUMBER, Rotation, Value, Vec, is_matrix, is_one_of, kind

SMALL = 1e-3
AXES = {"x": 0, "y": 1, "z": 2, "X": 0, "Y": 1, "Z": 2}


def _order(meter: Meter, scalar_first: Value) -> str:
    if not isinstance(scalar_first, bool):
        raise meter.fault("wrong_call", "scalar_first is True or False")
    return "wxyz" if scalar_first else "xyzw"


def _quat(meter: Meter, value: Value) -> Quat:
    if not isinstance(value, Rotation):
        raise meter.fault("wrong_type", f"a Rotation is needed here, not {kind(value)}")
    w, x, y, z = value.quat
    return w, x, y, z


def from_quat(meter: Meter, quat: Value, scalar_first: Value = False) -> Value:
    """Make a rotation from a quaternion, (x, y, z, w) unless scalar_first."""
    return Rotation(normalised(meter, read_quat(meter, quat, _order(meter, scalar_first))))


def from_angles(meter: Meter, seq: Value, angles: Value, degrees: Value = False) -> Value:
    """Make a rotation from angles about fixed axes ("xyz"), rotating axes ("ZYX") or a single axis."""
    values = as_vector(meter, angles)
    if degrees is True:
        values = of_one("deg2rad")(meter, values)
    if isinstance(seq, str) and seq in AXES and isinstance(values, NUMBER):
        parts: list[Value] = [0.0, 0.0, 0.0]
        parts[AXES[seq]] = values
        return Rotation(from_euler(meter, tuple(parts)))
    _check_sequence(meter, seq)
    items = components(meter, values)
    if len(items) != 3:
        raise meter.fault("wrong_size", f"{seq} takes 3 angles, not {len(items)}")
    return Rotation(from_euler(meter, items if seq == "xyz" else items[::-1]))


def _check_sequence(meter: Meter, seq: Value) -> None:
    if not is_one_of(seq, ("xyz", "ZYX")):
        raise meter.fault("wrong_call", "Euler angles are of 'xyz' or 'ZYX' here; quat_axis gives single directions")


def from_rotvec(meter: Meter, rotvec: Value) -> Value:
    """Make a rotation from its axis times its angle, rad."""
    items = components(meter, rotvec)
    if len(items) != 3:
        raise meter.fault("wrong_size", f"a rotation vector has 3 components, not {len(items)}")
    angle = _length(meter, items)
    square = scalar(meter, "*", angle, angle)
    near = scalar(meter, "-", 0.5, scalar(meter, "/", square, 48.0))
    safe = of_two("maximum")(meter, angle, SMALL)
    half = scalar(meter, "*", 0.5, angle)
    far = scalar(meter, "/", of_one("sin")(meter, scalar(meter, "*", 0.5, safe)), safe)
    scale = select(meter, scalar(meter, "<=", angle, SMALL), near, far)
    x, y, z = (scalar(meter, "*", scale, item) for item in items)
    return Rotation((of_one("cos")(meter, half), x, y, z))


def identity(meter: Meter) -> Value:
    """Return the identity rotation."""
    return Rotation((1.0, 0.0, 0.0, 0.0))


def _length(meter: Meter, items: tuple[Value, ...]) -> Value:
    return root(meter, number(meter, total(meter, tuple(scalar(meter, "*", x, x) for x in items))))


def as_quat(meter: Meter, rotation: Value, scalar_first: Value = False) -> Value:
    """Return the quaternion, (x, y, z, w) unless scalar_first."""
    return write_quat(_quat(meter, rotation), _order(meter, scalar_first))


def as_matrix(meter: Meter, rotation: Value) -> Value:
    """Return the rotation matrix, three rows."""
    return Vec(tuple(Vec(tuple(row)) for row in matrix(meter, _quat(meter, rotation))))


def as_euler(meter: Meter, rotation: Value, seq: Value, degrees: Value = False) -> Value:
    """Return the angles about the fixed axes "xyz" or the rotating axes "ZYX"."""
    _check_sequence(meter, seq)
    angles: Value = euler(meter, _quat(meter, rotation))
    if degrees is True:
        angles = of_one("rad2deg")(meter, angles)
    assert isinstance(angles, Vec)
    return angles if seq == "xyz" else Vec(angles.items[::-1])


def as_rotvec(meter: Meter, rotation: Value) -> Value:
    """Return the axis times the angle, 0 to pi rad."""
    w, *axis = _quat(meter, rotation)
    sign = select(meter, scalar(meter, "<", w, 0.0), -1.0, 1.0)
    angle = magnitude(meter, rotation)
    square = scalar(meter, "*", angle, angle)
    near = scalar(meter, "+", 2.0, scalar(meter, "/", square, 12.0))
    safe = of_two("maximum")(meter, angle, SMALL)
    far = scalar(meter, "/", safe, of_one("sin")(meter, scalar(meter, "*", 0.5, safe)))
    scale = scalar(meter, "*", sign, select(meter, scalar(meter, "<=", angle, SMALL), near, far))
    return Vec(tuple(scalar(meter, "*", scale, item) for item in axis))


def magnitude(meter: Meter, rotation: Value) -> Value:
    """Return the angle, 0 to pi rad."""
    w, *axis = _quat(meter, rotation)
    sine = _length(meter, tuple(axis))
    return scalar(meter, "*", 2.0, of_two("arctan2")(meter, sine, of_one("abs")(meter, w)))


def inverse(meter: Meter, rotation: Value) -> Value:
    """Return the inverse rotation."""
    return Rotation(conjugate(meter, _quat(meter, rotation)))


def apply(meter: Meter, rotation: Value, vectors: Value, inverse: Value = False) -> Value:
    """Rotate a vector, or the rows of a matrix."""
    quat = _quat(meter, rotation)
    if inverse is True:
        quat = conjugate(meter, quat)
    value = as_vector(meter, vectors)
    if is_matrix(value):
        assert isinstance(value, Vec)
        return Vec(tuple(_rotate_one(meter, quat, row) for row in value.items))
    return _rotate_one(meter, quat, value)


def _rotate_one(meter: Meter, quat: Quat, value: Value) -> Value:
    items = components(meter, value)
    if len(items) != 3:
        raise meter.fault("wrong_size", f"a vector of 3 is needed here, not of {len(items)}")
    return rotate(meter, quat, items)


def combined(meter: Meter, a: Value, b: Value) -> Value:
    """Compute `a * b`: rotation b followed by rotation a."""
    return Rotation(product(meter, _quat(meter, a), _quat(meter, b)))


MAKERS: dict[str, Callable[..., Value]] = {
    "from_quat": from_quat,
    "from_euler": from_angles,
    "from_rotvec": from_rotvec,
    "identity": identity,
}
OF_ROTATION: dict[str, Callable[..., Value]] = {
    "as_quat": as_quat,
    "as_matrix": as_matrix,
    "as_euler": as_euler,
    "as_rotvec": as_rotvec,
    "magnitude": magnitude,
    "inv": inverse,
    "apply": apply,
}

"""What `self` provides: the quantities of the schema, and their names in the paper's PyBullet environment."""

from __future__ import annotations

from collections.abc import Collection
from typing import cast

import numpy as np

from coral.contact.cost.context import Schema
from coral.contact.cost_program.limits import Mask, Meter
from coral.contact.cost_program.sharing import marks_of
from coral.contact.cost_program.values import BodyHandle, Marks, Value, Vec
from coral.errors import nearest

HAND_BODIES = ("panda", "robot", "arm", "hand", "gripper")
FIXED_BODIES = ("table", "wall", "plane")
HANDLES = (
    "cid",
    "client",
    "client_id",
    "physicsClientId",
    "physics_client",
    "grasp_link",
    "ee_link",
    "ee_link_index",
    "ee_index",
    "end_effector_index",
    "end_effector_link",
)
ID_ENDINGS = ("", "_id", "Id", "_uid", "_body")
NOT_THINGS = ("hand", "palm", "left", "right")


def objects_of(names: Collection[str]) -> list[str]:
    """Return the movable objects among the names of quantities."""
    return [
        name.removesuffix("_quat")
        for name in names
        if name.endswith("_quat")
        and name != "ee_quat"
        and f"{name.removesuffix('_quat')}_pos" in names
        and not name.endswith(("_init_quat", "_stage_quat"))
    ]


class StateSpace:
    """The names that a program may read from `self`, for one schema."""

    def __init__(self, schema: Schema) -> None:
        self.schema = schema
        self.objects = objects_of(schema)
        fixtures = {
            name.removeprefix(f"{thing}_").removesuffix("_contact")
            for thing in self.objects
            for name in schema
            if name.startswith(f"{thing}_") and name.endswith("_contact")
        }
        self.fixtures = sorted(fixtures - set(NOT_THINGS) - set(self.objects))
        self.bodies: dict[str, BodyHandle] = {}
        for name in (*HAND_BODIES, *self.objects, *sorted({*self.fixtures, *FIXED_BODIES})):
            body = BodyHandle("hand" if name in HAND_BODIES else name)
            for ending in ID_ENDINGS:
                self.bodies[name + ending] = body

    def available(self) -> list[str]:
        """Return every name that can be read."""
        return sorted(self.schema)

    def has(self, name: str) -> bool:
        """Check whether `self.name` can be read."""
        return bool(self.quantities(name)) or name in self.bodies or name in HANDLES

    def quantities(self, name: str) -> list[str]:
        """Return the quantities of the schema that `self.name` is computed from."""
        if name in self.schema:
            return [name]
        if name.endswith("_ori") and f"{name.removesuffix('_ori')}_quat" in self.schema:
            return [f"{name.removesuffix('_ori')}_quat"]
        if name == "in_contact":
            return [f"{thing}_hand_contact" for thing in self.objects if f"{thing}_hand_contact" in self.schema]
        return []

    def read(self, meter: Meter, name: str) -> Value:
        """Return the value of `self.name`.

        Raises:
            CostError: There is no such name.
        """
        found = self.quantities(name)
        if name in self.schema:
            return self._quantity(meter, name)
        if name == "in_contact" and found:
            touching = cast(Mask, self._quantity(meter, found[0]))
            for other in found[1:]:
                meter.made()
                touching = np.logical_or(touching, cast(Mask, self._quantity(meter, other)))
            return touching
        if found:
            quat = self._quantity(meter, found[0])
            assert isinstance(quat, Vec)
            w, x, y, z = quat.items
            return Vec((x, y, z, w), "xyzw", self._marks(meter, name))
        if name in self.bodies:
            return self.bodies[name]
        if name in HANDLES:
            return BodyHandle("other")
        raise self.unknown(meter, name)

    def unknown(self, meter: Meter, name: str) -> Exception:
        """Make the error for a name that `self` does not have."""
        sure = nearest(name, self.schema, likeness=0.8)
        listed = f"{nearest(name, self.schema)}; it has {', '.join(self.available())}"
        return meter.fault("unknown_state", f"the state has no {name!r}{sure or listed}")

    def _quantity(self, meter: Meter, name: str) -> Value:
        found = self.schema[name]
        if name not in meter.cache:
            meter.cache[name] = self._components(meter, name)
        parts = cast(tuple[Value, ...], meter.cache[name])
        if not found.size:
            return parts[0]
        return Vec(parts, "wxyz" if name.endswith("_quat") else "", self._marks(meter, name))

    def _marks(self, meter: Meter, name: str) -> Marks:
        """Return one mark for everything read from a quantity: its names must not diverge when one of them changes."""
        key = f"memory of {name}"
        if key not in meter.cache:
            meter.cache[key] = marks_of(Vec(()))
            meter.state_marks |= cast(Marks, meter.cache[key])
        return cast(Marks, meter.cache[key])

    def _components(self, meter: Meter, name: str) -> tuple[Value, ...]:
        """Return contiguous arrays, one per component: the same memory layout for every batch, so the same rounding."""
        quantity = self.schema[name]
        if name not in meter.context:
            raise meter.fault("missing_state", f"the batch lacks {name}")
        values = np.asarray(meter.context[name], dtype=np.float64)
        shape = values.shape[:2]
        fits = values.ndim == (3 if quantity.size else 2) and all(
            n in (1, m) for n, m in zip(shape, meter.context.shape, strict=True)
        )
        if not fits or (quantity.size and values.shape[2] != quantity.size):
            raise meter.fault("missing_state", f"{name} has shape {values.shape} in a batch of {meter.context.shape}")
        meter.made(max(quantity.size, 1))
        if quantity.size:
            return tuple(np.ascontiguousarray(values[..., i]) for i in range(quantity.size))
        return (values != 0,) if quantity.truth else (np.ascontiguousarray(values),)

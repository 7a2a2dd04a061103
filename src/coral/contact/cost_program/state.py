"""What `self` provides: the quantities of the schema."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from coral.contact.cost.context import Quantity, Schema
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.values import Array, Value
from coral.errors import nearest


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


def read_quantity(meter: Meter, schema: Schema, name: str) -> Value:
    """Return the value of `self.name`."""
    if name not in schema:
        sure = nearest(name, schema, likeness=0.8)
        listed = f"{nearest(name, schema)}; it has {', '.join(sorted(schema))}"
        raise meter.fault("unknown_state", f"the state has no {name!r}{sure or listed}")
    if name not in meter.cache:
        meter.cache[name] = _read(meter, schema[name], name)
    return meter.cache[name]


def _read(meter: Meter, quantity: Quantity, name: str) -> Array:
    """Return a contiguous array: the same memory layout for every batch, so the same rounding."""
    if name not in meter.context:
        raise meter.fault("missing_state", f"the batch lacks {name}")
    values = np.asarray(meter.context[name], dtype=np.float64)
    fits = values.ndim == (3 if quantity.size else 2) and all(
        n in (1, m) for n, m in zip(values.shape[:2], meter.context.shape, strict=True)
    )
    if not fits or (quantity.size and values.shape[2] != quantity.size):
        raise meter.fault("missing_state", f"{name} has shape {values.shape} in a batch of {meter.context.shape}")
    meter.made(max(quantity.size, 1))
    if quantity.truth and not quantity.size:
        return np.not_equal(values, 0)
    return np.ascontiguousarray(values.transpose(2, 0, 1) if quantity.size else values)

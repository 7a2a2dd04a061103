"""What `self` provides: the quantities of the schema."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from coral.contact.cost.context import Quantity, Schema
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.values import Value, Vec
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
    """Return the value of `self.name`.

    Raises:
        CostError: There is no such name, or the batch does not hold it as the schema says.
    """
    if name not in schema:
        sure = nearest(name, schema, likeness=0.8)
        listed = f"{nearest(name, schema)}; it has {', '.join(sorted(schema))}"
        raise meter.fault("unknown_state", f"the state has no {name!r}{sure or listed}")
    if name not in meter.cache:
        meter.cache[name] = _components(meter, schema[name], name)
    parts = meter.cache[name]
    return Vec(parts) if schema[name].size else parts[0]


def _components(meter: Meter, quantity: Quantity, name: str) -> tuple[Value, ...]:
    """Return contiguous arrays, one per component: the same memory layout for every batch, so the same rounding."""
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

"""isinstance: the Python type of a value."""

from __future__ import annotations

import numpy as np

from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.values import Builtin, DictValue, Seq, Value, Vec, kind

TYPES = ("float", "int", "bool", "str", "list", "tuple", "dict", "np.ndarray", "np.floating", "np.number", "np.float64")
OF_NUMPY = ("np.floating", "np.number", "np.float64")


def is_instance(meter: Meter, obj: Value, class_or_tuple: Value) -> Value:
    """Evaluate Python's isinstance, for a type or a tuple of types.

    Raises:
        CostError: The result would depend on how the state is stored.
    """
    wanted = class_or_tuple.items if isinstance(class_or_tuple, Seq) else (class_or_tuple,)
    names = [item.name for item in wanted if isinstance(item, Builtin) and item.bound is None]
    if len(names) != len(wanted) or not set(names) <= set(TYPES):
        raise meter.fault("wrong_call", f"isinstance takes {', '.join(TYPES)}")
    if set(names) & _certain(obj):
        return True
    if set(names) & _unsure(obj):
        raise meter.fault("wrong_type", f"whether {kind(obj)} is one depends on how it is stored; leave this out")
    return False


def _certain(value: Value) -> set[str]:
    if isinstance(value, np.ndarray):
        return set() if value.dtype == np.bool_ else {"float", "np.floating", "np.number", "np.float64"}
    if isinstance(value, bool):
        return {"bool", "int"}
    if isinstance(value, int | float | str):
        return {type(value).__name__}
    if isinstance(value, Vec):
        return {"np.ndarray"}
    if isinstance(value, Seq):
        return {value.kind} & {"list", "tuple"}
    return {"dict"} if isinstance(value, DictValue) else set()


def _unsure(value: Value) -> set[str]:
    """Return the types that the value may have in Python but that cannot be decided here."""
    if isinstance(value, np.ndarray):
        return {"int", "bool"} if value.dtype == np.bool_ else {"int"}
    return {*OF_NUMPY, "int"} if isinstance(value, int | float) else set()

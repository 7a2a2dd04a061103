"""The table of functions: what a program may call, and the shapes of arguments with which each gives what NumPy gives.

The wrapper of every function checks its arguments against the table, the reference page is written from it, and the
differential test calls every function with every shape that it offers.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from coral.contact.cost_program import functions
from coral.contact.cost_program.arithmetic import as_vector, dot, truth
from coral.contact.cost_program.functions import of_one, of_two, reduction
from coral.contact.cost_program.limits import MOST_TURNS, Meter
from coral.contact.cost_program.values import Builtin, Value, entries, is_number, is_vector, kind

WORDS: Mapping[str, tuple[Callable[[Value], bool], str]] = {
    "x": (lambda value: is_number(value) or is_vector(value), "a number or a vector"),
    "v": (is_vector, "a vector"),
    "n": (is_number, "a number"),
    "b": (lambda value: value is None or is_number(value) or is_vector(value), "a number, a vector or None"),
}
"""Words of the table: what the argument may be, and the same in words; the function checks any other argument."""


class Offer(NamedTuple):
    """A function of the table."""

    call: Callable[..., Value]
    """Takes the meter, then the arguments of the program."""
    takes: str
    """A word for each of its arguments, of `WORDS` or of the kinds of other arguments."""


Table = Mapping[str, Offer]


def builtin(name: str, offer: Offer) -> Builtin:
    """Wrap a function of the table as a builtin that checks its arguments."""
    signature = inspect.signature(offer.call)
    parameters = list(signature.parameters.values())[1:]
    words = dict(zip((one.name for one in parameters), offer.takes.split(), strict=False))
    all_given = len(parameters) * (all(one.kind is not one.VAR_POSITIONAL for one in parameters))

    def checked(meter: Meter, value: Value, word: str) -> Value:
        if word not in WORDS:
            return value
        (fits, text), found = WORDS[word], as_vector(meter, value)
        if not fits(found):
            raise meter.fault("wrong_type", f"{name} takes {text}, not {kind(value)}")
        return found

    def call(meter: Meter, args: list[Value], named: dict[str, Value]) -> Value:
        if named or len(args) != all_given:
            try:
                bound = signature.bind(meter, *args, **named)
            except TypeError as error:
                takes = ", ".join("..." if one.kind is one.VAR_POSITIONAL else one.name for one in parameters)
                raise meter.fault("wrong_call", f"{name} takes ({takes}): {error}") from None
            args = list(bound.args[1:])
            named = bound.kwargs
        given = [checked(meter, value, word) for value, word in zip(args, words.values(), strict=False)]
        given += args[len(given) :]
        return offer.call(meter, *given, **named)

    return Builtin(name, call)


def _extreme(symbol: str) -> Callable[..., Value]:
    def call(meter: Meter, *values: Value) -> Value:
        found = entries(meter, values[0]) if len(values) == 1 and not is_number(values[0]) else values
        if len(values) == 0 or not found:
            raise meter.fault("wrong_call", "max and min take several numbers or a list of them")
        return functions.largest(meter, found, symbol)

    return call


def _range(meter: Meter, *values: Value) -> Value:
    numbers = [value for value in values if isinstance(value, int)]
    if not 1 <= len(values) <= 3 or len(numbers) < len(values):
        raise meter.fault("not_fixed", "range takes one to three constant whole numbers")
    if len(numbers) == 3 and numbers[2] == 0:
        raise meter.fault("wrong_call", "the step of a range is not 0")
    found = range(*numbers)
    if len(found) > MOST_TURNS:
        raise meter.fault("steps", f"a range has at most {MOST_TURNS} entries")
    return list(found)


def _zip(meter: Meter, *values: Value) -> Value:
    return list(zip(*(entries(meter, value) for value in values), strict=False))


def _enumerate(meter: Meter, iterable: Value, start: Value = 0) -> Value:
    if not isinstance(start, int):
        raise meter.fault("not_fixed", "enumerate starts at a constant whole number")
    return list(enumerate(entries(meter, iterable), start))


def _sequence(sort: type[list[Value]] | type[tuple[Value, ...]]) -> Callable[..., Value]:
    def call(meter: Meter, values: Value = (), /) -> Value:
        return sort(entries(meter, values))

    return call


def _bool(meter: Meter, value: Value = False, /) -> Value:
    return truth(meter, value)


def _any(name: str) -> Callable[..., Value]:
    def call(meter: Meter, values: Value, /) -> Value:
        return functions.fold_truth(name, meter, entries(meter, values))

    return call


def _length(meter: Meter, value: Value, /) -> Value:
    if isinstance(value, list | tuple | dict) or is_vector(value):
        return len(value)
    raise meter.fault("wrong_type", f"{kind(value)} has no length")


OURS: Table = {
    "norm": Offer(functions.length, "x"),
    "dist": Offer(functions.dist, "v v"),
    "dot": Offer(dot, "v v"),
    "cross": Offer(functions.cross, "v v"),
    "clip": Offer(functions.clip, "x b b"),
    "clip01": Offer(functions.clip01, "x"),
    "sigmoid": Offer(functions.sigmoid, "x"),
    "near": Offer(functions.near, "x x"),
    **{name: Offer(of_one(getattr(np, name)), "x") for name in ("exp", "log", "sqrt", "tanh", "sin", "cos")},
    "quat_angle": Offer(functions.quat_angle, "v v"),
    "quat_axis": Offer(functions.quat_axis, "v index"),
    "quat_rotate": Offer(functions.quat_rotate, "v v"),
}
PYTHON: Table = {
    "abs": Offer(functions.absolute, "value"),
    "max": Offer(_extreme(">"), "list"),
    "min": Offer(_extreme("<"), "list"),
    "sum": Offer(functions.add_up, "list start"),
    "len": Offer(_length, "list"),
    "float": Offer(functions.to_float, "number"),
    "bool": Offer(_bool, "number"),
    "range": Offer(_range, "whole"),
    "zip": Offer(_zip, "list"),
    "enumerate": Offer(_enumerate, "list start"),
    "any": Offer(_any("any"), "truths"),
    "all": Offer(_any("all"), "truths"),
    "list": Offer(_sequence(list), "list"),
    "tuple": Offer(_sequence(tuple), "list"),
}
NUMPY: Table = {
    **{
        name: Offer(of_one(getattr(np, name)), "x")
        for name in (
            *("sqrt", "exp", "log", "sin", "cos", "tan", "tanh", "arcsin", "arccos", "arctan"),
            *("abs", "square", "sign", "deg2rad", "rad2deg", "radians", "degrees"),
        )
    },
    **{name: Offer(of_two(getattr(np, name)), "x x") for name in ("maximum", "minimum", "arctan2", "hypot")},
    "clip": Offer(functions.clip, "x b b"),
    "where": Offer(functions.select, "x x x"),
    "array": Offer(functions.array, "v dtype"),
    "asarray": Offer(functions.array, "v dtype"),
    "zeros": Offer(functions.filled_with(0.0), "size"),
    "ones": Offer(functions.filled_with(1.0), "size"),
    "concatenate": Offer(functions.concatenated, "arrays"),
    "append": Offer(functions.appended, "v x"),
    "dot": Offer(dot, "v v"),
    "cross": Offer(functions.cross, "v v"),
    **{name: Offer(reduction(name), "x") for name in ("sum", "mean", "max", "min", "any", "all")},
    "linalg.norm": Offer(functions.length, "x"),
}
MATH: Table = {
    **{name: Offer(of_one(getattr(np, name)), "n") for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "tanh")},
    **{name: Offer(of_one(getattr(np, name)), "n") for name in ("radians", "degrees")},
    **{name: Offer(of_one(getattr(np, f"arc{name[1:]}")), "n") for name in ("acos", "asin", "atan")},
    "fabs": Offer(of_one(np.abs), "n"),
    "atan2": Offer(of_two(np.arctan2), "n n"),
}
_CIRCLE = {"pi": math.pi, "e": math.e, "inf": math.inf}
CONSTANTS = {"np": _CIRCLE, "math": {**_CIRCLE, "tau": math.tau}}
METHODS: Table = {
    "copy": Offer(functions.copied, "v"),
    "dot": Offer(dot, "v v"),
    **{name: Offer(reduction(name), "v") for name in ("sum", "mean", "max", "min", "any", "all")},
}
_INSTEAD = {
    "np.mod np.remainder np.fmod math.fmod": "a % b",
    "np.power math.pow pow": "a ** b",
    "np.isclose np.allclose math.isclose": "abs(a - b) < 1e-6",
    "np.inner np.vdot np.matmul": "np.dot(a, b), of two vectors",
    "np.select np.piecewise np.heaviside": "np.where(condition, a, b)",
    "np.amax np.nanmax": "np.max(a)",
    "np.amin np.nanmin": "np.min(a)",
    "np.average np.median np.nanmean": "np.mean(a)",
    "np.std np.var": "np.mean((a - np.mean(a)) ** 2)",
    "np.float64 np.float32": "float(x)",
    "int": "the number itself; // for a count or an index; dtype=float, or nothing, for an array",
    "round math.floor math.ceil math.trunc": "the number itself: a cost in steps has no slope to follow",
    "np.floor np.ceil np.trunc np.fix np.rint np.round np.around": "the number itself: steps have no slope to follow",
    "np.int32 np.int64": "dtype=float, or nothing: arrays hold decimals",
    "np.add np.subtract np.multiply np.divide": "the operators + - * /",
    "np.fabs np.absolute": "np.abs(x)",
    "np.full np.full_like np.zeros_like np.ones_like": "value * np.ones(n)",
    "np.hstack np.r_": "np.concatenate([a, b])",
    "np.stack np.vstack np.column_stack np.reshape": "a list of vectors: an array has one axis",
    "np.eye np.identity np.outer np.transpose quat_matrix": "quat_rotate(q, v) and quat_axis(q, i), without matrices",
    "quat_multiply quat_inverse quat_euler": "quat_angle, quat_axis and quat_rotate",
    "np.arange np.linspace": "range(n) and a list",
    "math.fsum np.prod math.prod": "sum(xs), or a product in a loop",
    "np.nan_to_num np.isnan np.isfinite math.isnan math.isfinite": "self.NAME_seen, or a guard with max and min",
    "np.sinh np.cosh math.sinh math.cosh np.log1p": "np.exp and np.log",
    "np.log10 math.log10": "np.log(x) / np.log(10)",
    "np.acos np.asin np.atan np.atan2": "np.arccos, np.arcsin, np.arctan, np.arctan2",
    "np.logical_and np.logical_or np.logical_not np.bool_": "and, or, not, of single truth values",
    "np.copy": "the array itself: it cannot be changed",
    "math.dist": "dist(a, b)",
    "math.hypot": "np.hypot(x, y)",
    "sorted": "max and min, or np.where",
    "reversed": "xs[::-1]",
    "getattr hasattr": "self.NAME, of the names of this task",
    "isinstance": "the value as it is: what is a number and what a vector is known",
    "str": "the text itself",
    "print": "nothing: leave it out",
    "map": "[f(x) for x in xs]",
    "dict": "{...}",
    "set": "a list",
    "filter": "(x if ... else 0.0) in a list",
    "p pb pybullet": "self.NAME_pos, self.NAME_quat, self.NAME_vel and self.NAME_hand_contact",
    "Rotation": "quat_angle, quat_axis and quat_rotate",
}
INSTEAD = {name: text for names, text in _INSTEAD.items() for name in names.split()}
"""What to write instead of functions that are not offered."""


def _named(prefix: str, table: Table) -> dict[str, Builtin]:
    return {name: builtin(prefix + name, offer) for name, offer in table.items()}


BUILTINS: dict[str, Builtin] = {**_named("", OURS), **_named("", PYTHON)}
MODULES: dict[str, dict[str, Builtin]] = {"np": _named("np.", NUMPY), "math": _named("math.", MATH)}
VECTOR_METHODS: dict[str, Builtin] = _named("", METHODS)
MODULE_NAMES = {"np": "np", "numpy": "np", "math": "math"}


def instead(name: str) -> str:
    """Return a hint for a function that is not offered, or ""."""
    return f"; write {INSTEAD[name]}" if name in INSTEAD else ""

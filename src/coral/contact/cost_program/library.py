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

from coral.contact.cost_program import arrays, functions, orientations
from coral.contact.cost_program.arithmetic import as_vector, dot
from coral.contact.cost_program.functions import of_math, of_one, of_two, reduction
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.scalars import truth
from coral.contact.cost_program.values import Builtin, DictValue, Seq, Value, Vec, bounded, entries, kind

WORDS = {
    "x": ((Vec, np.ndarray, int, float), "a number or a vector"),
    "v": ((Vec,), "a vector"),
    "n": ((np.ndarray, int, float), "a number"),
    "b": ((Vec, np.ndarray, int, float, type(None)), "a number, a vector or None"),
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
    parameters = list(inspect.signature(offer.call).parameters.values())[1:]
    rest = any(p.kind is p.VAR_POSITIONAL for p in parameters)
    places = [p.name for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    keywords = [p.name for p in parameters if p.kind in (p.KEYWORD_ONLY, p.POSITIONAL_OR_KEYWORD)]
    needed = [p.name for p in parameters if p.default is p.empty and p.name in places]
    words = dict(zip((p.name for p in parameters), offer.takes.split(), strict=False))

    more = [offer.takes.split()[-1]] * 64 if rest else []

    def checked(meter: Meter, value: Value, word: str) -> Value:
        if word not in WORDS:
            return value
        (kinds, text), found = WORDS[word], as_vector(meter, value)
        if not isinstance(found, kinds):
            raise meter.fault("wrong_type", f"{name} takes {text}, not {kind(value)}")
        return found

    def call(meter: Meter, args: list[Value], named: dict[str, Value]) -> Value:
        missing = [n for n in needed[len(args) :] if n not in named]
        doubled = [n for n in places[: len(args)] if n in named]
        unknown = [n for n in named if n not in keywords]
        if unknown or doubled or missing or (len(args) > len(places) and not rest):
            takes = ", ".join([*places, *["..."] * rest, *(n for n in keywords if n not in places)])
            problem = (
                f"not {unknown[0]}="
                if unknown
                else f"{doubled[0]} once"
                if doubled
                else (f"so {missing[0]} is missing" if missing else f"not {len(args)} arguments")
            )
            raise meter.fault("wrong_call", f"{name} takes ({takes}), {problem}")
        given = [checked(meter, value, word) for value, word in zip(args, [*words.values(), *more], strict=False)]
        return offer.call(meter, *given, **{n: checked(meter, value, words.get(n, "")) for n, value in named.items()})

    return Builtin(name, call)


def _extreme(symbol: str) -> Callable[..., Value]:
    def call(meter: Meter, *values: Value) -> Value:
        if len(values) == 1:
            if not isinstance(values[0], Seq | Vec) or not values[0].items:
                raise meter.fault("wrong_call", "max and min take several numbers or a list of them")
            values = entries(meter, values[0])
        return functions.largest(meter, values, symbol)

    return call


def _range(meter: Meter, *values: Value) -> Value:
    if not 1 <= len(values) <= 3 or not all(isinstance(v, int) for v in values):
        raise meter.fault("not_fixed", "range takes one to three constant whole numbers")
    numbers = [int(v) for v in values if isinstance(v, int)]
    if len(numbers) == 3 and numbers[2] == 0:
        raise meter.fault("wrong_call", "the step of a range is not 0")
    found = range(*numbers)
    if len(found) > meter.cfg.loop:
        raise meter.fault("steps", f"a range has at most {meter.cfg.loop} entries")
    return Seq(tuple(found), "range")


def _zip(meter: Meter, *values: Value) -> Value:
    lists = [entries(meter, value) for value in values]
    return Seq(tuple(Seq(row, "tuple") for row in zip(*lists, strict=False)), "iterator")


def _enumerate(meter: Meter, iterable: Value, start: Value = 0) -> Value:
    if not isinstance(start, int):
        raise meter.fault("not_fixed", "enumerate starts at a constant whole number")
    pairs = enumerate(entries(meter, iterable), start)
    return Seq(tuple(Seq((i, item), "tuple") for i, item in pairs), "iterator")


def _sequence(name: str) -> Callable[..., Value]:
    def call(meter: Meter, *values: Value) -> Value:
        if len(values) > 1:
            raise meter.fault("wrong_call", f"{name} takes one list, not {len(values)}")
        return bounded(meter, Seq(entries(meter, values[0]) if values else (), name))

    return call


def _bool(meter: Meter, value: Value = False, /) -> Value:
    return truth(meter, value)


def _any(name: str) -> Callable[..., Value]:
    def call(meter: Meter, values: Value, /) -> Value:
        return functions.FOLDS[name](meter, entries(meter, values))

    return call


def _length(meter: Meter, value: Value, /) -> Value:
    if isinstance(value, Vec | DictValue) or (isinstance(value, Seq) and value.kind != "iterator"):
        return len(value.items)
    raise meter.fault("wrong_type", f"{kind(value)} has no length")


def _abs(meter: Meter, x: Value, /) -> Value:
    if isinstance(x, Seq):
        raise meter.fault("wrong_type", f"abs takes a number or an array, not {kind(x)}; use np.abs")
    found = functions.ABS(meter, x)
    return meter.as_plain(found) if meter.is_plain(x) else found


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
    "quat_angle": Offer(orientations.quat_angle, "v v"),
    "quat_axis": Offer(orientations.quat_axis, "v index"),
    "quat_rotate": Offer(orientations.quat_rotate, "v v"),
}
PYTHON: Table = {
    "abs": Offer(_abs, "value"),
    "max": Offer(_extreme(">"), "list"),
    "min": Offer(_extreme("<"), "list"),
    "sum": Offer(functions.add_up, "list start"),
    "len": Offer(_length, "list"),
    "float": Offer(arrays.to_plain, "number"),
    "int": Offer(arrays.to_int, "number"),
    "bool": Offer(_bool, "number"),
    "round": Offer(functions.whole_by(np.rint), "n"),
    "range": Offer(_range, "whole"),
    "zip": Offer(_zip, "list"),
    "enumerate": Offer(_enumerate, "list start"),
    "any": Offer(_any("any"), "truths"),
    "all": Offer(_any("all"), "truths"),
    "list": Offer(_sequence("list"), "list"),
    "tuple": Offer(_sequence("tuple"), "list"),
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
    "array": Offer(arrays.array, "v dtype"),
    "asarray": Offer(arrays.array, "v dtype"),
    "zeros": Offer(arrays.filled_with(0.0), "size"),
    "ones": Offer(arrays.filled_with(1.0), "size"),
    "concatenate": Offer(arrays.concatenated, "arrays"),
    "append": Offer(arrays.appended, "v x"),
    "dot": Offer(dot, "v v"),
    "cross": Offer(functions.cross, "v v"),
    **{name: Offer(reduction(name), "x") for name in functions.FOLDS},
    "linalg.norm": Offer(functions.length, "x"),
}
MATH: Table = {
    **{name: Offer(of_math(getattr(np, name)), "n") for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "tanh")},
    **{name: Offer(of_math(getattr(np, name)), "n") for name in ("radians", "degrees")},
    **{name: Offer(of_math(getattr(np, f"arc{name[1:]}")), "n") for name in ("acos", "asin", "atan")},
    "fabs": Offer(of_math(np.abs), "n"),
    "atan2": Offer(of_two(np.arctan2), "n n"),
    "floor": Offer(functions.whole_by(np.floor), "n"),
    "ceil": Offer(functions.whole_by(np.ceil), "n"),
}
_CIRCLE = {"pi": math.pi, "e": math.e, "inf": math.inf}
CONSTANTS = {"np": _CIRCLE, "math": {**_CIRCLE, "tau": math.tau}}
METHODS: Table = {
    "copy": Offer(arrays.copied, "v"),
    "dot": Offer(dot, "v v"),
    **{name: Offer(reduction(name), "v") for name in functions.FOLDS},
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
    "np.int32 np.int64 np.trunc np.fix math.trunc": "int(x)",
    "np.floor": "math.floor(x)",
    "np.ceil": "math.ceil(x)",
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
    "np.rint np.around np.round": "round(x)",
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

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
from coral.contact.cost_program.arithmetic import as_vector, dot, matmul
from coral.contact.cost_program.functions import of_math, of_one, of_two
from coral.contact.cost_program.iterating import entries, iterator
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.reductions import fold_truth, linalg_norm, reduction
from coral.contact.cost_program.scalars import truth
from coral.contact.cost_program.sharing import ONE_PASS
from coral.contact.cost_program.values import (
    Builtin,
    ContactList,
    DictValue,
    Seq,
    Value,
    Vec,
    bounded,
    depth,
    kind,
)


class Shapes(NamedTuple):
    """What an argument may be."""

    axes: tuple[int, ...]
    """Numbers of axes that are offered."""
    text: str
    """The same in words."""


WORDS = {
    "x": Shapes((0, 1, 2), "a number, vector or matrix"),
    "t": Shapes((0, 1, 2), "a truth value or an array of them"),
    "a": Shapes((1, 2), "a vector or matrix"),
    "v": Shapes((1,), "a vector"),
    "n": Shapes((0,), "a number"),
    "b": Shapes((0, 1, 2), "a number, vector, matrix or None"),
}
"""Words of the table; an argument with any other word is checked by the function itself."""


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
        if word not in WORDS or (value is None and word == "b"):
            return value
        allowed, found = WORDS[word], as_vector(meter, value)
        if depth(found) not in allowed.axes or not isinstance(found, Vec | np.ndarray | int | float):
            raise meter.fault("wrong_type", f"{name} takes {allowed.text}, not {kind(value)}")
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
    return iterator((Seq(row, "tuple") for row in zip(*lists, strict=False)), *values)


def _enumerate(meter: Meter, iterable: Value, start: Value = 0) -> Value:
    if not isinstance(start, int):
        raise meter.fault("not_fixed", "enumerate starts at a constant whole number")
    return iterator((Seq((i, item), "tuple") for i, item in enumerate(entries(meter, iterable), start)), iterable)


def _sequence(name: str) -> Callable[..., Value]:
    def call(meter: Meter, *values: Value) -> Value:
        if len(values) > 1:
            raise meter.fault("wrong_call", f"{name} takes one list, not {len(values)}")
        return bounded(meter, Seq(entries(meter, values[0]) if values else (), name))

    return call


def _dict(meter: Meter, args: list[Value], named: dict[str, Value]) -> Value:
    if len(args) > 1 or not all(isinstance(value, DictValue) for value in args):
        raise meter.fault("wrong_call", "dict takes keywords or another dict")
    items: dict[Value, Value] = dict(args[0].items) if args and isinstance(args[0], DictValue) else {}
    return DictValue(items | dict(named))


def _bool(meter: Meter, value: Value = False, /) -> Value:
    return truth(meter, value)


def _any(name: str) -> Callable[..., Value]:
    def call(meter: Meter, values: Value, /) -> Value:
        return fold_truth(meter, entries(meter, values), name)

    return call


def _length(meter: Meter, value: Value, /) -> Value:
    """Count the entries of a container; contact points count 1 if there are any."""
    if isinstance(value, ContactList):
        return value.touching.astype(np.int64)
    if isinstance(value, Vec | DictValue) or (isinstance(value, Seq) and value.kind not in ONE_PASS):
        return len(value.items)
    raise meter.fault("wrong_type", f"{kind(value)} has no length")


def _abs(meter: Meter, x: Value, /) -> Value:
    if isinstance(x, Seq):
        raise meter.fault("wrong_type", f"abs takes a number or an array, not {kind(x)}; use np.abs")
    found = functions.ABS(meter, x)
    return meter.as_plain(found) if meter.is_plain(x) else found


OURS: Table = {
    "norm": Offer(linalg_norm, "x ord axis flag"),
    "dist": Offer(functions.dist, "v v"),
    "dot": Offer(dot, "a a"),
    "cross": Offer(functions.cross, "v v"),
    "clip": Offer(functions.clip, "x b b"),
    "clip01": Offer(functions.clip01, "x"),
    "sigmoid": Offer(functions.sigmoid, "x"),
    "near": Offer(functions.near, "x x"),
    **{name: Offer(of_one(getattr(np, name)), "x") for name in ("exp", "log", "sqrt", "tanh", "sin", "cos")},
    "quat_angle": Offer(orientations.quat_angle, "v v"),
    "quat_axis": Offer(orientations.quat_axis, "v index"),
    "quat_rotate": Offer(orientations.quat_rotate, "v v"),
    "quat_multiply": Offer(orientations.quat_multiply, "v v"),
    "quat_inverse": Offer(orientations.quat_inverse, "v"),
    "quat_matrix": Offer(orientations.quat_matrix, "v"),
    "quat_euler": Offer(orientations.quat_euler, "v"),
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
            *("sqrt", "exp", "log", "log10", "log1p", "sin", "cos", "tan", "tanh", "arcsin", "arccos", "arctan"),
            *("abs", "absolute", "square", "sign", "floor", "ceil", "deg2rad", "rad2deg", "radians", "degrees"),
        )
    },
    **{name: Offer(of_two(getattr(np, name)), "x x") for name in ("maximum", "minimum", "arctan2", "hypot")},
    "clip": Offer(functions.clip, "x b b"),
    "where": Offer(functions.select, "t x x"),
    "round": Offer(functions.round_to, "x decimals"),
    "logical_and": Offer(functions.logical("and"), "t t"),
    "logical_or": Offer(functions.logical("or"), "t t"),
    "logical_not": Offer(functions.negation, "t"),
    "array": Offer(arrays.array, "a dtype"),
    "asarray": Offer(arrays.asarray, "a dtype"),
    "copy": Offer(arrays.copied, "a"),
    "zeros": Offer(arrays.filled_with(0.0), "shape dtype"),
    "ones": Offer(arrays.filled_with(1.0), "shape dtype"),
    "zeros_like": Offer(arrays.like(0), "a dtype"),
    "ones_like": Offer(arrays.like(1), "a dtype"),
    "eye": Offer(arrays.eye, "size"),
    "concatenate": Offer(arrays.joined(np.concatenate), "arrays axis"),
    "stack": Offer(arrays.joined(np.stack), "arrays axis"),
    "hstack": Offer(arrays.stacked(np.hstack), "arrays"),
    "vstack": Offer(arrays.stacked(np.vstack), "arrays"),
    "reshape": Offer(arrays.reshape, "a shape"),
    "ravel": Offer(arrays.ravel, "a"),
    "transpose": Offer(arrays.transpose, "a"),
    "dot": Offer(dot, "a a"),
    "matmul": Offer(matmul, "a a"),
    "cross": Offer(functions.cross, "v v"),
    "outer": Offer(functions.outer, "v v"),
    **{name: Offer(reduction(name), "x axis flag") for name in ("sum", "mean", "prod", "max", "min")},
    **{name: Offer(reduction(name), "t axis flag") for name in ("any", "all")},
    "linalg.norm": Offer(linalg_norm, "x ord axis flag"),
    "float64": Offer(arrays.to_float, "number"),
}
MATH: Table = {
    **{
        name: Offer(of_math(getattr(np, of)), "n")
        for name, of in {
            **{
                name: name
                for name in ("sqrt", "exp", "log", "log10", "sin", "cos", "tan", "tanh", "radians", "degrees")
            },
            "acos": "arccos",
            "asin": "arcsin",
            "atan": "arctan",
            "fabs": "abs",
        }.items()
    },
    "atan2": Offer(of_two(np.arctan2), "n n"),
    "hypot": Offer(functions.plain(functions.hypotenuse), "n"),
    "floor": Offer(functions.whole_by(np.floor), "n"),
    "ceil": Offer(functions.whole_by(np.ceil), "n"),
}
_CIRCLE: dict[str, float | None] = {"pi": math.pi, "e": math.e, "inf": math.inf}
CONSTANTS = {"np": {**_CIRCLE, "newaxis": None}, "math": {**_CIRCLE, "tau": math.tau}}
METHODS: Table = {
    "copy": Offer(arrays.copied, "a"),
    "dot": Offer(dot, "a a"),
    **{name: Offer(reduction(name), "a axis flag") for name in ("sum", "mean", "prod", "max", "min")},
    **{name: Offer(reduction(name), "a axis flag") for name in ("any", "all")},
    "astype": Offer(arrays.as_type, "a dtype"),
    "reshape": Offer(arrays.reshaped, "a shape"),
    "flatten": Offer(arrays.flatten, "a"),
    "ravel": Offer(arrays.ravel, "a"),
    "transpose": Offer(arrays.transpose, "a"),
    "clip": Offer(functions.clipped, "a b b"),
    "round": Offer(functions.round_to, "a decimals"),
    "tolist": Offer(arrays.to_list, "a"),
    "item": Offer(arrays.item, "a"),
}
INSTEAD = {
    **dict.fromkeys(("np.mod", "np.remainder"), "a % b"),
    **dict.fromkeys(("np.fmod", "math.fmod"), "a - b * int(a / b)"),
    **dict.fromkeys(("np.power", "np.float_power", "math.pow", "pow"), "a ** b"),
    **dict.fromkeys(("np.isclose", "np.allclose", "math.isclose"), "abs(a - b) < 1e-6"),
    **dict.fromkeys(("np.inner", "np.vdot"), "np.dot(a, b), of two vectors"),
    **dict.fromkeys(("np.select", "np.piecewise", "np.heaviside"), "np.where(condition, a, b)"),
    **dict.fromkeys(("np.interp",), "np.clip and a straight line"),
    **dict.fromkeys(("np.amax", "np.nanmax"), "np.max(a)"),
    **dict.fromkeys(("np.amin", "np.nanmin"), "np.min(a)"),
    **dict.fromkeys(("np.average", "np.median", "np.nanmean"), "np.mean(a)"),
    **dict.fromkeys(("np.std", "np.var"), "np.mean((a - np.mean(a)) ** 2)"),
    **dict.fromkeys(("np.float32", "np.float_", "np.double"), "float(x)"),
    **dict.fromkeys(("np.int32", "np.int64", "np.int_"), "int(x)"),
    **dict.fromkeys(("np.add", "np.subtract", "np.multiply", "np.divide"), "the operators + - * /"),
    **dict.fromkeys(("np.fabs",), "np.abs(x)"),
    **dict.fromkeys(("np.full", "np.full_like"), "value * np.ones(n)"),
    **dict.fromkeys(("np.identity",), "np.eye(n)"),
    **dict.fromkeys(("np.append", "np.column_stack", "np.r_", "np.c_"), "np.concatenate, np.stack or np.hstack"),
    **dict.fromkeys(("np.arange", "np.linspace"), "range(n) and a list"),
    **dict.fromkeys(("np.bool_",), "bool(x)"),
    **dict.fromkeys(("math.fsum", "math.prod"), "sum(xs), or a product in a loop"),
    **dict.fromkeys(
        ("np.nan_to_num", "np.isnan", "np.isfinite", "math.isnan", "math.isfinite"), "a guard with max and min"
    ),
    **dict.fromkeys(("np.sinh", "np.cosh", "math.sinh", "math.cosh"), "np.exp"),
    **dict.fromkeys(("np.trunc", "np.fix", "math.trunc"), "int(x)"),
    **dict.fromkeys(("np.rint", "np.around"), "np.round(x)"),
    **dict.fromkeys(("np.acos", "np.asin", "np.atan", "np.atan2"), "np.arccos, np.arcsin, np.arctan, np.arctan2"),
    "math.dist": "dist(a, b)",
    "sorted": "max and min, or np.where",
    "reversed": "xs[::-1]",
    "isinstance": "the value as it is: what is a number and what a vector is known",
    "str": "an f-string",
    "map": "[f(x) for x in xs]",
    "set": "a list",
    "filter": "[x for x in xs if ...]",
    "Rotation": "quat_angle, quat_axis, quat_rotate and quat_matrix",
}
"""What to write instead of functions that are not offered."""


def _named(prefix: str, table: Table) -> dict[str, Builtin]:
    return {name: builtin(prefix + name, offer) for name, offer in table.items()}


BUILTINS: dict[str, Builtin] = {**_named("", OURS), **_named("", PYTHON), "dict": Builtin("dict", _dict)}
MODULES: dict[str, dict[str, Builtin]] = {"np": _named("np.", NUMPY), "math": _named("math.", MATH)}
VECTOR_METHODS: dict[str, Builtin] = _named("", METHODS)
IMPORTABLE = {"numpy": "np", "np": "np", "math": "math", "pybullet": "p", "p": "p"}
MODULE_NAMES = {"np": "np", "numpy": "np", "math": "math", "p": "p", "pybullet": "p", "pb": "p"}


def instead(name: str) -> str:
    """Return a hint for a function that is not offered, or ""."""
    return f"; write {INSTEAD[name]}" if name in INSTEAD else ""

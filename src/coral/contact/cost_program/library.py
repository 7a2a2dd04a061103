"""Every function by the name that a program uses for it: builtins, `np`, `math` and our own."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from typing import Any

from coral.contact.cost_program import arrays, functions, orientations, statistics
from coral.contact.cost_program.arithmetic import dot, number, truth
from coral.contact.cost_program.functions import of_one, of_two
from coral.contact.cost_program.iterating import entries, iterator
from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.rotations import MAKERS, OF_ROTATION
from coral.contact.cost_program.texts import formatted
from coral.contact.cost_program.types_of import is_instance
from coral.contact.cost_program.values import Builtin, DictValue, Seq, Value, Vec, bounded

SILENT = ("dtype", "copy")  # keywords that change nothing here: every number is a float64


def builtin(name: str, function: Callable[..., Value]) -> Builtin:
    """Wrap a Python function of (meter, arguments...) as a builtin that checks its arguments."""
    parameters = list(inspect.signature(function).parameters.values())[1:]
    rest = any(p.kind is inspect.Parameter.VAR_POSITIONAL for p in parameters)
    names = [p.name for p in parameters if p.kind is inspect.Parameter.POSITIONAL_OR_KEYWORD]
    needed = [p.name for p in parameters if p.default is p.empty and p.name in names]

    def call(meter: Meter, args: list[Value], named: dict[str, Value]) -> Value:
        given = {key: value for key, value in named.items() if key not in SILENT or key in names}
        kind_given = given.get("dtype", named.get("dtype", args[1] if name == "astype" and len(args) > 1 else None))
        if isinstance(kind_given, Builtin) and kind_given.name not in ("float", "np.float64", "np.float32"):
            raise meter.fault("wrong_call", "arrays hold float64 only; leave dtype out or use float")
        missing = [n for n in needed[len(args) :] if n not in given]
        doubled = [n for n in names[: len(args)] if n in given]
        unknown = [n for n in given if n not in names]
        if unknown or doubled or missing or (len(args) > len(names) and not rest):
            takes = ", ".join(names + ["..."] * rest)
            problem = (
                f"not {unknown[0]}="
                if unknown
                else f"{doubled[0]} once"
                if doubled
                else (f"so {missing[0]} is missing" if missing else f"not {len(args)} arguments")
            )
            raise meter.fault("wrong_call", f"{name} takes ({takes}), {problem}")
        return function(meter, *args, **given)

    return Builtin(name, call)


def _extreme(symbol: str) -> Callable[..., Value]:
    def call(meter: Meter, *values: Value) -> Value:
        if len(values) == 1:
            if not isinstance(values[0], Seq | Vec) or not values[0].items:
                raise meter.fault("wrong_call", "max and min take several numbers or a list of them")
            values = entries(meter, values[0])
        return functions.largest(meter, tuple(number(meter, item) for item in values), symbol)

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
    def call(meter: Meter, value: Value = None) -> Value:
        return bounded(meter, Seq(entries(meter, value) if value is not None else (), name))

    return call


def _dict(meter: Meter, value: Value = None) -> Value:
    if value is None:
        return DictValue({})
    if not isinstance(value, DictValue):
        raise meter.fault("wrong_call", "dict takes keywords or another dict")
    return DictValue(dict(value.items))


def _reversed(meter: Meter, value: Value) -> Value:
    return iterator(entries(meter, value)[::-1], value, kind="reversed")


def _bool(meter: Meter, value: Value = False) -> Value:
    return truth(meter, value)


def _any(name: str) -> Callable[..., Value]:
    def call(meter: Meter, values: Value) -> Value:
        return functions.fold_truth(meter, entries(meter, values), name)

    return call


def _dict_call(meter: Meter, args: list[Value], named: dict[str, Value]) -> Value:
    base = DICT.call(meter, args, {})
    assert isinstance(base, DictValue)
    return DictValue(dict(base.items) | dict(named))


def _scalar_math(name: str) -> Callable[..., Value]:
    function = of_one(name)

    def call(meter: Meter, x: Value) -> Value:
        return function(meter, number(meter, x))

    return call


def _text_of(meter: Meter, value: Value = "") -> Value:
    return formatted(meter, value, -1, "")


def _no_function(name: str) -> Callable[..., Value]:
    def call(meter: Meter, *values: Value) -> Value:
        raise meter.fault("wrong_call", f"{name} is a type to ask for with isinstance; use np.array to make arrays")

    return call


DICT = builtin("dict", _dict)
OURS: dict[str, Callable[..., Value]] = {
    "norm": functions.linalg_norm,
    "dist": functions.dist,
    "dot": dot,
    "cross": functions.cross,
    "clip": functions.clip,
    "clip01": functions.clip01,
    "sigmoid": functions.sigmoid,
    "near": functions.near,
    "exp": of_one("exp"),
    "log": of_one("log"),
    "sqrt": of_one("sqrt"),
    "tanh": of_one("tanh"),
    "sin": of_one("sin"),
    "cos": of_one("cos"),
    "quat_angle": orientations.quat_angle,
    "quat_axis": orientations.quat_axis,
    "quat_rotate": orientations.quat_rotate,
    "quat_multiply": orientations.quat_multiply,
    "quat_inverse": orientations.quat_inverse,
    "quat_matrix": orientations.quat_matrix,
    "quat_euler": orientations.quat_euler,
}
PYTHON: dict[str, Callable[..., Value]] = {
    "abs": of_one("abs"),
    "max": _extreme(">"),
    "min": _extreme("<"),
    "sum": functions.add_up,
    "len": functions.length,
    "float": arrays.to_float,
    "int": arrays.to_int,
    "bool": _bool,
    "range": _range,
    "zip": _zip,
    "enumerate": _enumerate,
    "round": functions.round_to,
    "any": _any("any"),
    "all": _any("all"),
    "list": _sequence("list"),
    "tuple": _sequence("tuple"),
    "reversed": _reversed,
    "pow": functions.power,
}
MORE_PYTHON: dict[str, Callable[..., Value]] = {
    "sorted": statistics.sorted_list,
    "isinstance": is_instance,
    "str": _text_of,
    "map": _no_function("map"),
}
ARRAY: dict[str, Callable[..., Value]] = {
    **{name: of_one(name) for name in functions.UNARY},
    **{name: of_two(name) for name in functions.BINARY},
    "add": functions.operator_call("+"),
    "subtract": functions.operator_call("-"),
    "multiply": functions.operator_call("*"),
    "divide": functions.operator_call("/"),
    "array": arrays.array,
    "asarray": arrays.asarray,
    "asfarray": arrays.asarray,
    "zeros": arrays.zeros,
    "ones": arrays.ones,
    "full": arrays.full,
    "zeros_like": arrays.like(0.0),
    "ones_like": arrays.like(1.0),
    "eye": arrays.eye,
    "identity": arrays.eye,
    "append": arrays.append,
    "concatenate": arrays.concatenate,
    "hstack": arrays.concatenate,
    "stack": arrays.stack,
    "vstack": arrays.stack,
    "reshape": arrays.reshape,
    "ravel": arrays.ravel,
    "transpose": arrays.transpose,
    "diag": arrays.diag,
    "copy": arrays.copied,
    "dot": dot,
    "inner": dot,
    "vdot": dot,
    "matmul": dot,
    "cross": functions.cross,
    "outer": functions.outer,
    "clip": functions.clip,
    "where": functions.select,
    "power": functions.power,
    "float_power": functions.power,
    "isclose": functions.isclose,
    "round": functions.round_to,
    "around": functions.round_to,
    "sum": functions.reduction("sum"),
    "mean": functions.reduction("mean"),
    "average": statistics.average,
    "std": statistics.deviation,
    "var": statistics.variance,
    "median": statistics.median,
    "sort": statistics.sort,
    "cumsum": statistics.cumulated,
    "diff": statistics.differences,
    "interp": statistics.interpolated,
    "select": statistics.chosen,
    "arange": statistics.arange,
    "linspace": statistics.linspace,
    "max": functions.reduction("max"),
    "min": functions.reduction("min"),
    "amax": functions.reduction("max"),
    "amin": functions.reduction("min"),
    "prod": functions.reduction("prod"),
    "any": functions.reduction("any"),
    "all": functions.reduction("all"),
    "logical_and": functions.logical("and"),
    "logical_or": functions.logical("or"),
    "logical_not": functions.negation,
    "absolute": of_one("abs"),
    "fabs": of_one("abs"),
    "acos": of_one("arccos"),
    "asin": of_one("arcsin"),
    "atan": of_one("arctan"),
    "atan2": of_two("arctan2"),
    "arctan2": of_two("arctan2"),
    "radians": of_one("deg2rad"),
    "degrees": of_one("rad2deg"),
    "float64": arrays.to_float,
    "float32": arrays.to_float,
    "float_": arrays.to_float,
    "bool_": _bool,
    **{name: _no_function(f"np.{name}") for name in ("ndarray", "floating", "number")},
    "linalg.norm": functions.linalg_norm,
}
MATH: dict[str, Callable[..., Value]] = {
    **{
        name: _scalar_math(name)
        for name in (
            "sqrt",
            "exp",
            "expm1",
            "log",
            "log1p",
            "log10",
            "log2",
            "sin",
            "cos",
            "tan",
            "sinh",
            "cosh",
            "tanh",
            "floor",
            "ceil",
            "trunc",
            "isfinite",
            "isnan",
            "isinf",
        )
    },
    "acos": _scalar_math("arccos"),
    "asin": _scalar_math("arcsin"),
    "atan": _scalar_math("arctan"),
    "atan2": of_two("arctan2"),
    "fabs": _scalar_math("abs"),
    "radians": _scalar_math("deg2rad"),
    "degrees": _scalar_math("rad2deg"),
    "pow": functions.power,
    "hypot": statistics.hypotenuse,
    "fmod": of_two("fmod"),
    "copysign": of_two("copysign"),
    "dist": functions.dist,
    "isclose": functions.isclose,
    "fsum": functions.add_up,
    "prod": functions.reduction("prod"),
}
CONSTANTS: dict[str, float | None] = {"newaxis": None, "pi": math.pi, "e": math.e, "inf": math.inf, "tau": math.tau}

METHODS: dict[str, Callable[..., Value]] = {
    "copy": arrays.copied,
    "dot": dot,
    "sum": functions.reduction("sum"),
    "mean": functions.reduction("mean"),
    "max": functions.reduction("max"),
    "min": functions.reduction("min"),
    "any": functions.reduction("any"),
    "all": functions.reduction("all"),
    "prod": functions.reduction("prod"),
    "std": statistics.deviation,
    "var": statistics.variance,
    "astype": arrays.as_type,
    "reshape": arrays.reshape,
    "flatten": arrays.flatten,
    "ravel": arrays.ravel,
    "transpose": arrays.transpose,
    "clip": functions.clip,
    "round": functions.round_to,
    "tolist": arrays.to_list,
    "squeeze": arrays.squeezed,
    "item": arrays.to_float,
}


def _named(prefix: str, table: dict[str, Any]) -> dict[str, Builtin]:
    return {name: builtin(prefix + name, function) for name, function in table.items()}


BUILTINS: dict[str, Builtin] = {
    **_named("", OURS),
    **_named("", PYTHON),
    **_named("", MORE_PYTHON),
    "dict": Builtin("dict", _dict_call),
}
MODULES: dict[str, dict[str, Builtin]] = {
    "np": _named("np.", ARRAY),
    "math": _named("math.", MATH),
    "Rotation": _named("Rotation.", MAKERS),
}
VECTOR_METHODS: dict[str, Builtin] = _named("", METHODS)
ROTATION_METHODS: dict[str, Builtin] = _named("", OF_ROTATION)
IMPORTABLE = {"scipy.spatial.transform": "scipy", "numpy": "np", "np": "np", "math": "math", "pybullet": "p", "p": "p"}
MODULE_NAMES = {"np": "np", "numpy": "np", "math": "math", "p": "p", "pybullet": "p", "pb": "p"}

"""Generated calls and programs: the interpreter of costs gives what Python and NumPy give, state by state, or refuses.

Usage: python benchmarks/fuzz_programs.py [--calls N] [--programs N] [--seed N] [--show N]

The calls are made from the interpreter's own table: every function and method with arguments of every shape and kind of
number, in positions and as keywords. The programs are made by a grammar of statements. Each is evaluated on a batch by
the interpreter, and by Python itself once for each state, with numbers of NumPy and with plain ones. Values and shapes
must agree. Exit code 1 if one differs without a word. What is accepted where Python raises is counted: a division by
zero is infinite here, and refused at the end if the cost is.
"""

from __future__ import annotations

import argparse
import inspect
import math
import random
import re
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np

from coral.contact.cost.context import Context, Quantity
from coral.contact.cost_program import CostError, CostProgram
from coral.contact.cost_program.errors import CODES
from coral.contact.cost_program.library import BUILTINS, MATH, METHODS, NUMPY, OURS, PYTHON
from coral.contact.cost_program.values import Builtin, Value

SHAPE = (2, 2)
STATES = [(0, 0, False), (0, 1, False), (1, 0, False), (1, 1, False), (0, 1, True)]
"""Index of each state that Python evaluates, and whether its numbers are plain ones."""
SCHEMA = {
    "time": Quantity(0, "s", ""),
    "gripper_opening": Quantity(0, "m", ""),
    "box_mass": Quantity(0, "kg", "", constant=True),
    "ee_pos": Quantity(3, "m", ""),
    "box_pos": Quantity(3, "m", ""),
    "box_quat": Quantity(4, "", ""),
    "goal_pos": Quantity(3, "m", "", constant=True),
    "last_action": Quantity(7, "", ""),
    "box_hand_contact": Quantity(0, "", "", truth=True),
    "box_table_contact": Quantity(0, "", "", truth=True),
}
NUMBERS = [
    *("self.time", "self.gripper_opening", "self.box_mass", "0.5", "-1.5", "2", "0", "1e3"),
    *("float(self.time)", "math.sqrt(self.gripper_opening)"),
    *("max(self.ee_pos[1], 0.0)", "(self.ee_pos[2] if self.box_hand_contact else 0.0)", "-float(self.gripper_opening)"),
]
TRUTHS = ["self.box_hand_contact", "self.box_table_contact", "(self.time > 0.5)", "(self.ee_pos[0] < 0.0)", "True"]
VECTORS = [
    *("self.ee_pos", "self.box_pos", "self.goal_pos", "self.box_quat", "self.last_action", "[0.1, -0.2, 0.3]"),
    *("np.array([1, 2, 3])", "np.array([0, -1])", "np.ones(1)", "self.ee_pos[:2]", "(0.5, self.time)", "np.zeros(3)"),
    *("self.ee_pos[::-1]", "[2, 0, 1]"),
]
TRUTH_VECTORS = ["(self.ee_pos > 0.0)", "np.array([True, False, True])", "[self.box_hand_contact, True, False]"]
ODD = [
    "None",
    "'a'",
    "[]",
    "np.zeros(0)",
    "self",
    "{'a': 1.0}",
    "[[1.0], [1.0, 2.0]]",
    "(x for x in self.ee_pos)",
    "[self.ee_pos, self.box_pos]",
]
OF_SHAPE = {0: (NUMBERS, TRUTHS), 1: (VECTORS, TRUTH_VECTORS)}
AXES = {"x": (0, 1), "v": (1,), "n": (0,), "b": (0, 1)}
OTHERS = {
    "dtype": ["float", "int", "'float32'", "None", "bool"],
    "size": ["2", "3", "0", "1.5", "-1", "(2, 3)"],
    "start": ["0", "1", "2.5", "self.time"],
    "index": ["0", "1", "2", "3", "-1", "True"],
    "whole": ["3", "0", "-1", "2.0"],
}
"""Values of the words of the table that are no arrays."""
OPERATORS = ["+", "-", "*", "/", "//", "%", "**", "@", "<", "<=", ">", ">=", "==", "!=", "and", "or"]
INDICES = [
    *("0", "-1", "1:", "::-1", ":2", "1", "5", "-4", "True", "self.time", "0.0", "1:1", "None", "0, 1", "[0, 1]")
]
ITERATORS = ("zip", "enumerate", "range")


def quat_matrix(q: Any) -> Any:
    """Return the rotation matrix of a (w, x, y, z) quaternion."""
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


REAL: dict[str, Any] = {
    "np": np,
    "math": math,
    "norm": np.linalg.norm,
    "dist": lambda a, b: np.linalg.norm(np.subtract(a, b)),
    "clip": np.clip,
    "clip01": lambda x: np.clip(x, 0.0, 1.0),
    "sigmoid": lambda x: 0.5 + 0.5 * np.tanh(0.5 * np.asarray(x))[()],
    "near": lambda d, s: np.exp(-((np.asarray(d) / s) ** 2))[()],
    **{name: getattr(np, name) for name in ("exp", "log", "sqrt", "tanh", "sin", "cos", "dot", "cross")},
    "quat_angle": lambda a, b: 2 * np.arccos(min(1.0, abs(np.dot(a, b)))),
    "quat_axis": lambda q, axis: quat_matrix(q)[:, axis],
    "quat_rotate": lambda q, v: quat_matrix(q) @ v,
}
"""Our own functions in NumPy; those that take quaternions are compared with unit ones."""
LEFT_OUT = {name for name in OURS if name not in REAL} | {"quat_angle", "quat_axis", "quat_rotate"}
"""Functions of quaternions: their own tests compare them."""


def batch(seed: int) -> Context:
    """Make states, some of whose numbers are 0, 1 or equal to others."""
    rng, values = np.random.default_rng(seed), {}
    for name, quantity in SCHEMA.items():
        shape = (*((1, 1) if quantity.constant else SHAPE), *([quantity.size] if quantity.size else []))
        found = rng.normal(size=shape).round(2)
        special = rng.random(shape)
        found[special < 0.1] = 0.0
        found[special > 0.9] = 1.0
        if quantity.truth:
            found = (found > 0.0).astype(float)
        if name.endswith("_quat"):
            found = np.where(np.arange(4) == 0, found + 3.0, found)
            found /= np.linalg.norm(found, axis=-1, keepdims=True)
        values[name] = np.abs(found) if name in ("time", "gripper_opening", "box_mass") else found
    return Context(values, SHAPE)


@lru_cache(64)
def _numbers(state: Context, i: int, j: int, plain: bool) -> dict[str, Any]:
    number, truth = (float, bool) if plain else (np.float64, np.bool_)
    found = {}
    for name, quantity in SCHEMA.items():
        value = np.broadcast_to(state[name], (*SHAPE, *state[name].shape[2:]))[i, j]
        found[name] = value if quantity.size else (truth if quantity.truth else number)(value)
    return found


def one_state(state: Context, i: int, j: int, plain: bool) -> SimpleNamespace:
    """Return `self` of one state, its numbers NumPy's or plain ones."""
    found = _numbers(state, i, j, plain)
    return SimpleNamespace(**{k: v.copy() if isinstance(v, np.ndarray) else v for k, v in found.items()})


def spread(value: Value, i: int, j: int) -> Any:
    """Return a value of the interpreter as NumPy has it in one state."""
    if isinstance(value, list | tuple):
        return type(value)(spread(item, i, j) for item in value)
    if isinstance(value, np.ndarray):
        return np.broadcast_to(value, (*value.shape[:-2], *SHAPE))[..., i, j]
    return value


def same(found: Any, wanted: Any) -> bool:
    """Check whether two values have the same shape, and the same numbers up to rounding."""
    if isinstance(wanted, dict | Iterator | SimpleNamespace):
        return True  # what they hold is compared where it is used
    if isinstance(found, list | tuple) or isinstance(wanted, list | tuple):
        return (
            isinstance(found, list | tuple)
            and type(found) is type(wanted)
            and len(found) == len(wanted)
            and all(map(same, found, wanted))
        )
    if found is None or isinstance(found, str) or not isinstance(wanted, int | float | np.ndarray | np.generic):
        return type(found) is type(wanted) and bool(found == wanted)
    if isinstance(found, float) and isinstance(wanted, float):
        return math.isclose(found, wanted, rel_tol=1e-9, abs_tol=1e-12) or (found != found and wanted != wanted)
    a, b = np.asarray(found), np.asarray(wanted)
    return a.shape == b.shape and bool(
        np.allclose(a.astype(float), b.astype(float), rtol=1e-9, atol=1e-12, equal_nan=True)
    )


@dataclass
class Tally:
    """What came of the cases."""

    counts: Counter[str] = field(default_factory=Counter)
    """Same, refused, raised (refused by both), accepted (where Python raises), different."""
    reasons: Counter[str] = field(default_factory=Counter)
    """Codes of the refusals of what Python accepts."""
    findings: list[tuple[str, str, str]] = field(default_factory=list)
    """Kind, text of the case, and what differs."""

    def add(self, outcome: str, case: str, text: str = "") -> None:
        """Count a case."""
        self.counts[outcome] += 1
        if outcome == "different":
            self.findings.append((outcome, case, text))

    def refused(self) -> float:
        """Return the share of what Python accepts that is refused."""
        given = self.counts["same"] + self.counts["different"] + self.counts["refused"]
        return self.counts["refused"] / max(1, given)


def odd_in_numpy(case: str, python: Callable[[], Any]) -> bool:
    """Check whether NumPy divides whole numbers by 0, which gives 0, or takes a generator for one object."""
    if re.search(r"(np\.\w+\(|[=!<>]=? )\(.* for ", case):
        return True
    try:
        with np.errstate(divide="raise"):
            python()
    except FloatingPointError:
        return True
    return False


def compare(tally: Tally, case: str, state: Context, ours: Callable[[], Any], python: Callable[[Any], Any]) -> None:
    """Evaluate a case both ways and count it.

    Args:
        tally: Where it is counted.
        case: Its text.
        state: The batch.
        ours: Returns the interpreter's value.
        python: Returns Python's value for one `self`.
    """
    error = None
    try:
        value = ours()
    except CostError as caught:
        error = caught
        if error.code not in CODES or error.code == "internal":
            tally.add("different", case, str(error))
            return
    except Exception as crash:
        tally.add("different", case, f"{type(crash).__name__} in the interpreter: {crash}")
        return
    outcome, text = "same", ""
    for i, j, plain in STATES:
        try:
            wanted = python(one_state(state, i, j, plain))
            if isinstance(wanted, complex):  # a root of a negative number of Python's own, which no cost can be
                raise TypeError("a complex number")
            if isinstance(wanted, np.ndarray) and wanted.dtype.kind == "O":  # of a generator: no cost can be one
                raise TypeError("an array of objects")
        except Exception as raised:
            if not plain:
                outcome, text = "accepted", f"{type(raised).__name__}: {raised}"
            continue
        if error is None and not same(spread(value, i, j), wanted):
            if odd_in_numpy(case, lambda i=i, j=j, plain=plain: python(one_state(state, i, j, plain))):
                outcome, text = "accepted", "NumPy's value is no number that anybody means"
                continue
            tally.add("different", case, f"{spread(value, i, j)!r}, Python {wanted!r} in {i}, {j}, {plain}")
            return
    if error is None:
        tally.add(outcome, case, text)
    else:
        tally.add("raised" if outcome == "accepted" else "refused", case)
        tally.reasons[error.code] += outcome == "same"


class Calls:
    """Writes calls from the table.

    Args:
        seed: Of the random choices.
    """

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        tables = [("", PYTHON), ("", OURS), ("np.", NUMPY), ("math.", MATH)]
        self.functions = [
            (prefix + name, offer.takes.split(), offer.call)
            for prefix, table in tables
            for name, offer in table.items()
            if prefix or name not in LEFT_OUT
        ]
        self.methods = [(name, offer.takes.split(), offer.call) for name, offer in METHODS.items()]

    def operand(self, word: str = "x", loose: float = 0.15) -> str:
        """Write an argument for a word of the table, sometimes of another shape or kind."""
        pick = self.random
        if word in OTHERS:
            return pick.choice(OTHERS[word])
        if pick.random() < 0.02:
            return pick.choice(ODD)
        axes = AXES.get(word, (0, 1))
        plain, truths = OF_SHAPE[pick.choice(axes if pick.random() > loose else (0, 1))]
        if word in ("list", "arrays", "truths") and pick.random() < 0.7:
            same_shape = OF_SHAPE[1 if word == "arrays" else 0][word == "truths"]
            first = pick.choice(same_shape)
            others = [first if pick.random() < 0.3 else pick.choice(same_shape) for _ in range(pick.randint(0, 2))]
            return f"[{', '.join([first, *others])}]"
        if word == "number":
            plain = OF_SHAPE[0][0] if pick.random() > loose else plain
        wants_truth = (word == "truths") != (pick.random() < loose)
        found = pick.choice(truths if wants_truth else plain)
        return f"({found} {pick.choice(OPERATORS[:6])} {self.operand(word, 0.0)})" if pick.random() < 0.1 else found

    def call(self) -> str:
        """Write a call, an operator, an index or a chain of two."""
        pick = self.random
        kind = pick.random()
        if kind < 0.55:
            return self._of(*pick.choice(self.functions))
        if kind < 0.7:
            name, words, function = pick.choice(self.methods)
            arguments = self._arguments(words[1:], function, 1)
            return f"{self.operand(words[0])}.{name}({arguments})"
        if kind < 0.85:
            return f"({self.operand()} {pick.choice(OPERATORS)} {self.operand()})"
        if kind < 0.92:
            return f"({self.operand('v')})[{pick.choice(INDICES)}]"
        if kind < 0.94:
            return f"({pick.choice(['-', '+', 'not ', 'abs'])}({self.operand()}))"
        inner = self._of(*pick.choice(self.functions))
        name, words, _ = pick.choice([f for f in self.functions if len(f[1]) <= 2 and f[0] not in ITERATORS])
        rest = [self.operand(word) for word in words[1:] if word not in OTHERS]
        return f"{name}({', '.join([inner, *rest])})"

    def _of(self, name: str, words: list[str], function: Callable[..., Any]) -> str:
        if name in ("max", "min", "zip") and self.random.random() < 0.5:
            found = ", ".join(self.operand("n") for _ in range(self.random.randint(1, 3)))
            return f"[x for x in {name}({found})]" if name == "zip" else f"{name}({found})"
        found = self._arguments(words, function, 0)
        return f"[x for x in {name}({found})]" if name in ITERATORS else f"{name}({found})"

    def _arguments(self, words: list[str], function: Callable[..., Any], skipped: int) -> str:
        parameters = list(inspect.signature(function).parameters.values())[1 + skipped :]
        names = [p.name for p in parameters if p.kind is not p.VAR_POSITIONAL]
        needed = sum(p.default is p.empty and p.kind is not p.VAR_POSITIONAL for p in parameters)
        count = len(words) if self.random.random() < 0.4 else max(1 - skipped, min(len(words), needed))
        found, keyed = [], False
        for at, word in enumerate([*words, "x"][: count + (self.random.random() < 0.02)]):
            if at >= len(names) and keyed:
                break
            keyed = keyed or (needed <= at < len(names) and self.random.random() < 0.6)
            found.append(f"{names[at]}={self.operand(word)}" if keyed else self.operand(word))
        return ", ".join(found)


def compiled(text: str, mode: str) -> Any:
    """Compile generated text for Python itself; None if it is no Python."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return compile(text, "<case>", mode)
        except SyntaxError:
            return None


def check_calls(count: int, seed: int) -> Tally:
    """Compare generated calls: value and shape."""
    tally, writer, state = Tally(), Calls(seed), batch(seed)
    kept: list[Value] = []

    def keep(_: Any, args: list[Value], named: dict[str, Value]) -> Value:
        kept.append(args[0])
        return 0.0

    BUILTINS["observe"] = Builtin("observe", keep)
    try:
        for k in range(count):
            if k % 500 == 0:
                state = batch(seed + k)
            text = writer.call()
            source = f"def state_cost(self):\n    return observe({text})"
            code = compiled(text, "eval")
            if code is None:
                tally.counts["no Python"] += 1
                continue

            def ours(source: str = source, state: Context = state) -> Value:
                kept.clear()
                CostProgram(source, SCHEMA).evaluate(state)
                return kept[0]

            def python(one: Any, code: Any = code) -> Any:
                found = eval(code, {**REAL, "self": one})
                return found.tolist() if isinstance(found, range) else found

            compare(tally, text, state, ours, python)
    finally:
        del BUILTINS["observe"]
    return tally


class Programs:
    """Writes programs by a grammar of statements.

    Args:
        seed: Of the random choices.
    """

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.calls = Calls(seed)
        self.numbers: list[str] = []
        self.vectors: list[str] = []
        self.count = 0

    def number(self, deep: int = 2) -> str:
        """Write a number."""
        pick = self.random
        kind = pick.randrange(14) if deep else pick.randrange(3)
        a, b = (lambda: self.number(deep - 1)), (lambda: self.vector(deep - 1))
        if kind < 3:
            return pick.choice([*self.numbers, *NUMBERS[:6]])
        if kind < 5:
            return f"({a()} {pick.choice('+-*')} {a()})"
        if kind == 5:
            return f"({a()} {pick.choice(['/', '//', '%'])} {pick.choice(['2.0', '(1.0 + abs(' + a() + '))', '3'])})"
        if kind == 6:
            return f"{pick.choice(['max', 'min', 'np.maximum', 'np.minimum'])}({a()}, {a()})"
        if kind == 7:
            return f"{pick.choice(['np.exp', 'np.tanh', 'abs', 'float', 'math.cos', 'sigmoid'])}({a()})"
        if kind == 8:
            return f"{pick.choice(['np.linalg.norm', 'np.sum', 'sum', 'max', 'len', 'norm', 'np.mean'])}({b()})"
        if kind == 9:
            return pick.choice([f"np.dot({b()}, {b()})", f"({b()} @ {b()})", f"{b()}[{pick.choice('012')}]"])
        if kind == 10:
            return f"({a()} if {self.truth(deep - 1)} else {a()})"
        if kind == 11:
            return f"np.where({self.truth(deep - 1)}, {a()}, {a()})"
        if kind == 12:
            return f"sum({pick.choice(['w * x', 'abs(x)', 'x ** 2'])} for x in {b()}{pick.choice(['', '[:2]'])})"
        return self.calls.call()

    def vector(self, deep: int = 2) -> str:
        """Write a vector of three."""
        pick = self.random
        kind = pick.randrange(8) if deep else 0
        if kind < 3:
            return pick.choice([*self.vectors, *VECTORS[:3], "np.array([1, 2, 3])"])
        if kind == 3:
            return f"({self.vector(deep - 1)} {pick.choice('+-*')} {self.vector(deep - 1)})"
        if kind == 4:
            return f"({self.number(deep - 1)} * {self.vector(deep - 1)})"
        if kind == 5:
            return f"np.array([{self.number(0)}, {self.number(0)}, {self.number(0)}])"
        if kind == 6:
            return f"np.{pick.choice(['clip', 'where'])}({self.vector(deep - 1)}, -0.5, 0.5)"
        return f"({self.vector(0)} if {self.truth(0)} else {self.vector(0)})"

    def truth(self, deep: int = 1) -> str:
        """Write a condition."""
        pick = self.random
        kind = pick.randrange(6) if deep else pick.randrange(3)
        if kind < 2:
            return pick.choice(TRUTHS)
        if kind < 4:
            return f"({self.number(1)} {pick.choice(OPERATORS[8:14])} {self.number(1)})"
        if kind == 4:
            return f"({self.truth(0)} {pick.choice(['and', 'or'])} {self.truth(0)})"
        return f"(not {self.truth(0)})"

    def block(self, pad: str, deep: int, loop: bool) -> list[str]:
        """Write some statements, whose new names are not used after them."""
        numbers, vectors = list(self.numbers), list(self.vectors)
        lines = [line for _ in range(self.random.randint(1, 3)) for line in self.statement(pad, deep, loop)]
        self.numbers, self.vectors = numbers, vectors
        return lines

    def statement(self, pad: str, deep: int, loop: bool = False) -> list[str]:
        """Write one statement."""
        pick, more = self.random, pad + "    "
        kind = pick.randrange(26 if deep else 15)
        self.count += 1
        name = pick.choice(["sum", "d", "w", "total", "max", "x"]) if pick.random() < 0.1 else f"x{self.count}"
        if kind < 3:
            line = f"{pad}{name} = {self.number()}"
            self.numbers.append(name)
            return [line]
        if kind < 5:
            line = f"{pad}v{self.count} = {self.vector()}{pick.choice(['', '', '.copy()', ' * 1.0'])}"
            self.vectors.append(f"v{self.count}")
            return [line]
        if kind < 8:
            return [f"{pad}cost {pick.choice(['+=', '+=', '-=', '*='])} {self.number()}"]
        if kind == 8 and self.vectors and pick.random() < 0.05:
            return [f"{pad}{pick.choice(self.vectors)} {pick.choice(['+=', '-=', '*='])} {self.number(1)}"]
        if kind == 9 and pick.random() < 0.05:
            return [f"{pad}{pick.choice(['ts = terms', 'terms = ts', *['ts = {}'] * 6, 'ts[0] = 1.0'])}"]
        if kind == 10:
            return [f"{pad}xs = xs + [{self.number(1)}]", f"{pad}cost += sum(xs)"]
        if kind == 11:
            return [f"{pad}terms[{pick.choice(['a', 'b', 'c'])!r}] = {self.number(1)}"]
        if kind == 12:
            line = pick.choice(["cost = cost * 0.5", "x0, w = w, x0", "terms['a'] += 0.5", "ys = xs"])
            return [f"{pad}{line}", *([f"{pad}cost += (cost := {self.number(0)})"] if pick.random() < 0.1 else [])]
        if kind == 13 and self.numbers:
            return [f"{pad}{pick.choice(self.numbers)} {pick.choice(['+=', '-=', '*='])} {self.number(1)}"]
        if kind < 16:
            return [f"{pad}cost += {self.number(1)}  # part {self.count}"]
        if kind < 20:
            lines = [f"{pad}if {self.truth()}:", *self.block(more, deep - 1, loop)]
            return [*lines, f"{pad}else:", *self.block(more, deep - 1, loop)] if pick.random() < 0.6 else lines
        if kind == 20:
            over = pick.choice(["range(3)", self.vector(0), "list(xs)", f"[{self.number(0)}, {self.number(0)}]"])
            return [f"{pad}for x in {over}:", *self.block(more, deep - 1, True), f"{more}cost += x"]
        if kind == 21 and loop:
            return [
                f"{pad}if {pick.choice(['len(xs) > 1', 'True', self.truth()])}:",
                f"{more}{pick.choice(['break', 'continue'])}",
            ]
        if kind == 22:
            return [f"{pad}if {self.truth()}:", f"{more}return cost + {self.number(1)}"]
        if kind == 23:
            called = pick.choice(["f", "sum", "norm", "float"])
            body = [f"{more}if {self.truth()}:", f"{more}    return x * 2.0"] if pick.random() < 0.5 else []
            return [f"{pad}def {called}(x, w=0.5):", *body, f"{more}return {pick.choice(['x + w', 'w', 'x * x'])}",
                    f"{pad}cost += {called}({self.number(1)})"]  # fmt: skip
        if kind == 24:
            return [f"{pad}g = lambda x: x + {self.number(0)}", f"{pad}cost += g({self.number(0)})"]
        return [f"{pad}cost += sum(terms.values())"]

    def program(self) -> str:
        """Write a program."""
        self.numbers, self.vectors, self.count = ["x0", "w"], ["u"], 0
        lines = ["def state_cost(self):", "    cost, xs, terms, ts = 0.0, [], {'a': 0.5}, {'a': 2.0}",
                 "    x0, w, u = self.time * 2.0, 0.25, self.ee_pos - self.box_pos"]  # fmt: skip
        for _ in range(self.random.randint(1, 5)):
            lines += self.statement("    ", 2)
        end = self.random.choice(
            ["cost", "cost", "-cost", "cost + np.sum(u)", "cost + sum(xs)", "sum(terms.values())", "sum(ts.values())"]
        )
        return "\n".join([*lines, f"    return {end}"])


def check_programs(count: int, seed: int) -> Tally:
    """Compare generated programs."""
    tally, writer, state = Tally(), Programs(seed), batch(seed)
    for k in range(count):
        if k % 100 == 0:
            state = batch(seed + k)
        source = writer.program()
        code = compiled(source, "exec")
        if code is None:
            tally.counts["no Python"] += 1
            continue

        def ours(source: str = source, state: Context = state) -> Value:
            return sum(CostProgram(source, SCHEMA).evaluate(state).values())

        def python(one: Any, code: Any = code) -> Any:
            names = dict(REAL)
            exec(code, names)
            return float(names["state_cost"](one))

        compare(tally, source, state, ours, python)
    return tally


def table(rows: dict[str, Tally]) -> Iterator[str]:
    """Write the tallies as a table."""
    yield "| cases | number | same | refused | refused by both | accepted, Python raises | different | share refused |"
    yield "|---|---:|---:|---:|---:|---:|---:|---:|"
    for name, tally in rows.items():
        n = tally.counts
        yield (
            f"| {name} | {n.total() - n['no Python']} | {n['same']} | {n['refused']} | {n['raised']} "
            f"| {n['accepted']} | {n['different']} | {tally.refused():.1%} |"
        )


def main() -> int:
    """Compare calls and programs, and print what differs."""
    flags = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    flags.add_argument("--calls", type=int, default=100_000)
    flags.add_argument("--programs", type=int, default=10_000)
    flags.add_argument("--seed", type=int, default=0)
    flags.add_argument("--show", type=int, default=10)
    chosen = flags.parse_args()
    begun = time.monotonic()
    warnings.simplefilter("ignore")
    warnings.simplefilter("error", DeprecationWarning)
    rows = {
        "calls": check_calls(chosen.calls, chosen.seed),
        "programs": check_programs(chosen.programs, chosen.seed),
    }
    for tally in rows.values():
        for outcome, case, text in tally.findings[: chosen.show]:
            print(f"{outcome}: {case}\n    {text}")
    print("\n".join(table(rows)))
    for name, tally in rows.items():
        print(f"{name} refused: {dict(tally.reasons.most_common(8))}")
    print(f"{time.monotonic() - begun:.0f} s, seed {chosen.seed}")
    return 1 if any(tally.findings for tally in rows.values()) else 0


if __name__ == "__main__":
    sys.exit(main())

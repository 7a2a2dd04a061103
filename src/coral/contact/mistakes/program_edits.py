"""Edits of a cost program that keep it valid: change, scale or drop a term, shift a place, swap objects."""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable
from typing import Any

import numpy as np

FACTOR = 10.0


def flip_sign(code: str, rng: np.random.Generator) -> str | None:
    """Flip the sign of a term; None if there is no term."""
    return _change_term(code, rng, lambda term: ast.UnaryOp(ast.USub(), term))


def scale_term(code: str, rng: np.random.Generator) -> str | None:
    """Multiply a term's weight by ten or divide it by ten."""
    factor = FACTOR if rng.random() < 0.5 else 1.0 / FACTOR
    return _change_term(code, rng, lambda term: ast.BinOp(ast.Constant(factor), ast.Mult(), term))


def drop_term(code: str, rng: np.random.Generator) -> str | None:
    """Drop one term of a cost; None if there is only one."""
    tree = _parse(code)
    terms = [] if tree is None else _terms(tree)
    if len(terms) < 2 or tree is None:
        return None
    holder, field, index = terms[int(rng.integers(len(terms)))]
    if index is not None:
        del getattr(holder, field)[index]
        if isinstance(holder, ast.Dict):
            del holder.keys[index]
    else:
        setattr(holder, field, ast.Constant(0.0))
    return _text(tree)


def shift_place(code: str, rng: np.random.Generator, off_m: tuple[float, float]) -> str | None:
    """Shift a place by some centimetres along one axis: a vector of numbers, or a height in a comparison."""
    tree = _parse(code)
    if tree is None:
        return None
    off = float(rng.uniform(*off_m)) * (1.0 if rng.random() < 0.5 else -1.0)
    spots: list[tuple[list[ast.expr], int]] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.List) and len(node.elts) == 3 and all(map(_number, node.elts)):
            values = [_value(one) for one in node.elts]
            if any(values) and sorted(map(abs, values)) != [0.0, 0.0, 1.0]:  # axes are no places
                spots += [(node.elts, axis) for axis in range(3)]
    heights = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.BinOp)
        and isinstance(node.op, ast.Sub)
        and _number(node.right)
        and ("_pos" in ast.unparse(node.left) or isinstance(node.left, ast.Subscript))
    ]
    if not spots and not heights:
        return None
    chosen = int(rng.integers(len(spots) + len(heights)))
    if chosen < len(spots):
        elements, axis = spots[chosen]
        elements[axis] = ast.Constant(round(_value(elements[axis]) + off, 4))
    else:
        node = heights[chosen - len(spots)]
        node.right = ast.Constant(round(_value(node.right) + off, 4))
    return _text(tree)


def rename_quantities(code: str, one: str, other: str) -> str | None:
    """Replace one object's quantities by another's; None if the program reads none of the first."""
    made = code.replace(f"self.{one}_", f"self.{other}_")
    return None if made == code else made


def turn_axis(code: str, axis: int) -> str | None:
    """Reverse an axis of every object, not of the hand; None if the program reads none."""
    tree = _parse(code)
    if tree is None:
        return None
    turned = _Turn(axis)
    made = turned.visit(tree)
    return _text(made) if turned.done else None


def tighten(condition: str) -> str | None:
    """Move the bound of a comparison so far that nothing fulfils it; None if there is no comparison with a number."""
    tree = _parse(condition)
    if tree is None:
        return None
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare) and _number(node.comparators[0]):
            bound = _value(node.comparators[0])
            less = isinstance(node.ops[0], ast.Lt | ast.LtE)
            near = bound / 100.0 if bound > 0 else bound - 0.2
            node.comparators[0] = ast.Constant(round(near if less else max(1.5 * bound, bound + 0.2), 6))
            return _text(tree)
    return None


class _Turn(ast.NodeTransformer):
    def __init__(self, axis: int) -> None:
        self.axis, self.done = axis, False

    def visit_Call(self, node: ast.Call) -> Any:
        if isinstance(node.func, ast.Name) and node.func.id == "abs":
            return node  # the same for both directions, as in a grasp
        self.generic_visit(node)
        text = ast.unparse(node)
        if text.startswith("quat_axis(self.") and text.endswith(f", {self.axis})") and "self.ee_" not in text:
            self.done = True
            return ast.UnaryOp(ast.USub(), node)
        return node


def _change_term(code: str, rng: np.random.Generator, change: Callable[[ast.expr], ast.expr]) -> str | None:
    tree = _parse(code)
    terms = [] if tree is None else _terms(tree)
    if tree is None or not terms:
        return None
    holder, field, index = terms[int(rng.integers(len(terms)))]
    if index is None:
        setattr(holder, field, change(getattr(holder, field)))
    else:
        term = getattr(holder, field)[index]
        if isinstance(term, ast.expr):
            getattr(holder, field)[index] = change(term)
        else:
            term.value = change(term.value)
    return _text(tree)


def _terms(tree: ast.Module) -> list[tuple[Any, str, int | None]]:
    """Locate the terms of a cost: its named ones, else the summands of the returned value."""
    found: list[tuple[Any, str, int | None]] = []
    for node in ast.walk(tree):
        body = getattr(node, "body", ())
        for index, statement in enumerate(body if isinstance(body, list) else ()):
            named = isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Subscript)
            if named or isinstance(statement, ast.AugAssign):
                found.append((node, "body", index))
    if not found:
        for node in ast.walk(tree):
            if isinstance(node, ast.Return) and isinstance(node.value, ast.Dict):
                found += [(node.value, "values", index) for index in range(len(node.value.values))]
            elif isinstance(node, ast.Return) and isinstance(node.value, ast.BinOp):
                found += _summands(node, "value")
    return found


def _summands(holder: Any, field: str) -> list[tuple[Any, str, int | None]]:
    node = getattr(holder, field)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return [*_summands(node, "left"), *_summands(node, "right")]
    return [(holder, field, None)]


def _number(node: ast.expr) -> bool:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        node = node.operand
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool)


def _value(node: ast.expr) -> float:
    return float(ast.literal_eval(node))


def _parse(code: str) -> ast.Module | None:
    try:
        return ast.parse(code)
    except SyntaxError:
        return None


def _text(tree: ast.AST) -> str:
    return ast.unparse(ast.fix_missing_locations(copy.deepcopy(tree)))

"""The end of a stage as comparisons: which of them hold in a state, and how far the others are from holding.

A condition such as `norm(self.ee_pos - self.box_pos) < 0.02 and self.box_left_contact` holds or does not; its parts
tell why. The text is only taken apart here. The sides of the comparisons are evaluated as one small program, by the
same interpreter as the condition itself, in the confined process if that is where the condition runs.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, cast

import numpy as np

from coral.contact.cost.context import Context, Cost, Schema
from coral.contact.cost_program import CostError
from coral.contact.cost_program.arithmetic import OPERATORS
from coral.contact.cost_program.expressions import SYMBOLS
from coral.contact.plan.cost_plan import Loader, PlanAnswer, flat, in_process

Operator = Literal["<", "<=", ">", ">=", "==", "!=", "holds", "fails"]
CONTRARY: Mapping[Operator, Operator] = {
    "<": ">=",
    "<=": ">",
    ">": "<=",
    ">=": "<",
    "==": "!=",
    "!=": "==",
    "holds": "fails",
    "fails": "holds",
}
TRUTH, UNKNOWN = "truth", "?"
"""In place of a unit: a truth value such as a contact, and what the text does not reveal."""
MOST_PARTS = 16
LONGEST_TEXT = 120


@dataclass(frozen=True)
class EndPart:
    """One comparison of a condition."""

    text: str
    """As in the condition."""
    operator: Operator
    """The comparison; "holds" and "fails" are those of a single value."""
    unit: str
    """Unit of what is compared, "" without one; TRUTH or UNKNOWN."""
    left: str
    """Text of the left side, or of the single value."""
    right: str
    """Text of the right side; "0.5" for a single value, which holds above it."""


@dataclass(frozen=True)
class PartReading:
    """The two sides of a comparison in one state."""

    part: EndPart
    left: float
    right: float

    @property
    def holds(self) -> bool:
        """Return whether the comparison holds."""
        operator = {"holds": ">", "fails": "<="}.get(self.part.operator, self.part.operator)
        return bool(OPERATORS[operator](self.left, self.right))

    @property
    def missing(self) -> float:
        """Return how far the left side is from where the comparison holds, in its unit; 0 if it holds."""
        return 0.0 if self.holds else abs(self.left - self.right)


class StageEnd:
    """The condition that ends a stage, part by part; all parts must hold.

    `program` computes their sides as the terms `left 0`, `right 0` and so on.
    """

    def __init__(self, parts: tuple[EndPart, ...], program: Cost) -> None:
        self.parts, self._program = parts, program

    def read(self, now: Context) -> tuple[PartReading, ...]:
        """Evaluate the comparisons on a batch of one; () if they cannot be evaluated there."""
        try:
            terms = self._program(now)
        except CostError:
            return ()
        side = {name: float(np.asarray(term).flat[0]) for name, term in terms.items()}
        return tuple(PartReading(part, side[f"left {k}"], side[f"right {k}"]) for k, part in enumerate(self.parts))


def stage_ends(plan: PlanAnswer, schema: Schema, load: Loader = in_process) -> dict[str, StageEnd]:
    """Return the ends of a plan's stages by name, without those that have no parts and the last, which nothing ends."""
    found = {}
    for stage in plan.each()[:-1]:
        parts = parts_of(stage.done, schema)
        if not parts:
            continue
        try:
            found[stage.name] = StageEnd(parts, load(_sides(parts), schema, stage.name))
        except CostError:
            continue
    return found


def parts_of(condition: str, schema: Schema) -> tuple[EndPart, ...]:
    """Take a condition as `StageAnswer.done` apart at its outermost `and`; () if there is none, or it cannot be parsed.

    A part of another form, such as an `or`, is a single truth value of an unknown unit.
    """
    try:
        tree = ast.parse(flat(condition), mode="eval")
        parts = tuple(_split(tree.body, schema))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ()
    return parts if len(parts) <= MOST_PARTS else ()


def _split(node: ast.expr, schema: Schema, negated: bool = False) -> Iterator[EndPart]:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield from _split(node.operand, schema, not negated)
    elif isinstance(node, ast.BoolOp) and isinstance(node.op, ast.Or if negated else ast.And):
        for value in node.values:
            yield from _split(value, schema, negated)
    elif isinstance(node, ast.Compare) and not (negated and len(node.ops) > 1):
        left = node.left
        for op, right in zip(node.ops, node.comparators, strict=True):
            yield _comparison(left, op, right, schema, negated)
            left = right
    else:
        yield _single(node, schema, negated)


def _comparison(left: ast.expr, op: ast.cmpop, right: ast.expr, schema: Schema, negated: bool) -> EndPart:
    written = ast.Compare(left, [op], [right])
    operator = cast(Operator | None, SYMBOLS.get(type(op)))
    if operator is None:  # `is`, `in`: whether it holds is all that is known
        return _single(written, schema, negated)
    text = ast.unparse(written)
    return EndPart(
        _shortened(f"not {text}" if negated else text),
        CONTRARY[operator] if negated else operator,
        _unit(written, schema),
        ast.unparse(left),
        ast.unparse(right),
    )


def _single(node: ast.expr, schema: Schema, negated: bool) -> EndPart:
    text = ast.unparse(node)
    unit = _unit(node, schema)
    return EndPart(
        _shortened(f"not ({text})" if negated else text),
        "fails" if negated else "holds",
        TRUTH if unit == TRUTH and isinstance(node, ast.Attribute) else UNKNOWN,
        text,
        "0.5",
    )


def _unit(node: ast.expr, schema: Schema) -> str:
    """Return the unit of the quantities that a comparison reads, if it is one: directions and shares have none."""
    names = [
        each.attr if isinstance(each, ast.Attribute) else str(each.value)
        for each in ast.walk(node)
        if isinstance(each, ast.Attribute | ast.Constant)
    ]
    read = [schema[name] for name in names if name in schema]
    if read and all(quantity.truth for quantity in read):
        return TRUTH
    units = {quantity.unit for quantity in read if quantity.unit}
    if any(quantity.truth for quantity in read) or len(units) > 1 or (units and _squares(node)):
        return UNKNOWN
    return units.pop() if units else ""


def _squares(node: ast.expr) -> bool:
    """Check whether something is raised to a power and no root is taken."""
    called = {ast.unparse(each.func).rpartition(".")[2] for each in ast.walk(node) if isinstance(each, ast.Call)}
    return not called & {"sqrt", "norm"} and any(isinstance(each, ast.Pow) for each in ast.walk(node))


def _sides(parts: tuple[EndPart, ...]) -> str:
    terms = [
        f"'{side} {k}': 1.0 * ({text})"
        for k, part in enumerate(parts)
        for side, text in (("left", part.left), ("right", part.right))
    ]
    return f"def state_cost(self):\n    return {{{', '.join(terms)}}}"


def _shortened(text: str) -> str:
    return text if len(text) <= LONGEST_TEXT else f"{text[: LONGEST_TEXT - 3]}..."

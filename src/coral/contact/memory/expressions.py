"""Numbers of a plan that were the size or the place of something, as expressions of the scene.

An author who writes 0.0361 for a box of 0.0722 means half of its height; in another scene that number is another one.
Which numbers mean something is inferred: a length of the program that equals a share of a size, plus a margin of the
hand, to the last digit. Round lengths are margins and tolerances, and stay, unless they repeat a height or a place
that the task states, or count along an axis of the object. The inference can err: an adapted plan passes the same
checks as any answer, and is rehearsed beside the plan with its numbers as they were.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict, FiniteFloat

from coral.contact.plan.contact_regions import LOWEST_M, PAD_M, TIP_M
from coral.contact.plan.cost_plan import PlanAnswer

LONGEST_M = 1.0
"""A larger number is no length on the table."""
MARGIN_STEP_M = 0.005
LARGEST_MARGIN_M = 0.15
HAND_MARGINS_M = (PAD_M, TIP_M, LOWEST_M, PAD_M + LOWEST_M, PAD_M + TIP_M)
"""Lengths of the hand, which authors add to a size."""
MARGINS_M = tuple(
    sorted({k * MARGIN_STEP_M for k in range(round(LARGEST_MARGIN_M / MARGIN_STEP_M) + 1)} | set(HAND_MARGINS_M))
)
"""Margins that authors add to a size: multiples of 5 mm, and lengths of the hand."""
SHARES = (1.0, 0.5, 0.4, 0.3, 0.25)
"""Shares of a size."""
LIFT_MARGIN_M = 0.03
"""Largest margin above a height that the goals ask for."""
ROUND_DIGITS = 3
"""A length with at most this many decimals is round: a size in metres is hardly ever."""
SAME_M = 1e-4
PROGRAMS = ("code", "done", "lost", "toward")


class SizeExpression(BaseModel):
    """A length as a sum of shares of the scene's numbers, plus a margin in metres.

    Args:
        shares: Share of each number of the scene (`scene_numbers`).
        margin_m: What is added to them.
    """

    model_config = ConfigDict(extra="forbid")
    shares: dict[str, FiniteFloat]
    margin_m: FiniteFloat = 0.0

    def value(self, numbers: Mapping[str, float]) -> float | None:
        """Return the length in a scene; None if the scene lacks one of the numbers."""
        if not set(self.shares) <= set(numbers):
            return None
        return sum(share * numbers[key] for key, share in self.shares.items()) + self.margin_m

    def text(self) -> str:
        """Return the expression for people, as `0.5 object0.size.2 + 0.025`."""
        parts = [key if share == 1 else f"{share:g} {key}" for key, share in self.shares.items()]
        if self.margin_m:
            parts.append(f"{self.margin_m:g}")
        return " + ".join(parts).replace("+ -", "- ")


@dataclass(frozen=True)
class Length:
    """A number of a program that may be a length."""

    node: ast.Constant
    """Its place in the program."""
    text: str
    """The number as it is written."""
    axis: int | None = None
    """World axis along which it counts, if the program says so."""
    side: int | None = None
    """The same for an axis of an object, as in `0.05 * quat_axis(self.box_quat, 0)`."""

    @property
    def key(self) -> str:
        """Return the number with its axis: one number may mean two things along two axes."""
        if self.side is not None:
            return f"{self.text} along side {self.side}"
        return self.text if self.axis is None else f"{self.text} along {'xyz'[self.axis % 3]}"

    @property
    def decimals(self) -> int:
        """Return the number of written decimals."""
        return len(self.text.partition(".")[2])


def find_expressions(plan: PlanAnswer, numbers: Mapping[str, float]) -> dict[str, SizeExpression]:
    """Find the lengths of a plan that are sizes, heights or places of its scene.

    Args:
        plan: The plan.
        numbers: Numbers of the scene for which it was written.

    Returns:
        Expressions by the number as it is written in the programs, with its axis (`Length.key`).
    """
    found: dict[str, SizeExpression] = {}
    for stage in plan.each():
        for field in PROGRAMS:
            for length in lengths_in(getattr(stage, field)):
                if length.key not in found and (expression := _express(length, numbers)) is not None:
                    found[length.key] = expression
    return found


def lengths_in(program: str) -> list[Length]:
    """Return the numbers of a program that are added, compared or part of a vector; none if it cannot be parsed."""
    text = program.strip()
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return []
    lines = text.split("\n")
    found = []
    for node, axis, side in _candidates(tree):
        if node.lineno == node.end_lineno and node.end_col_offset is not None:
            written = lines[node.lineno - 1].encode()[node.col_offset : node.end_col_offset].decode()
            if _is_length(node):
                found.append(Length(node, written, axis, side))
    return found


def replace_lengths(program: str, values: Mapping[str, float]) -> str:
    """Return a program with some of its lengths replaced; those that differ by less than 0.1 mm stay as written.

    Args:
        program: The program.
        values: New values by the number as it is written, with its axis (`Length.key`).
    """
    start = len(program) - len(program.lstrip())
    lines = program.strip().split("\n")
    for length in sorted(lengths_in(program), key=lambda one: (one.node.lineno, one.node.col_offset), reverse=True):
        if abs(values.get(length.key, float(length.text)) - float(length.text)) > SAME_M:
            line = lines[length.node.lineno - 1].encode()
            new = f"{values[length.key]:.5g}".encode()
            lines[length.node.lineno - 1] = (
                line[: length.node.col_offset] + new + line[length.node.end_col_offset :]
            ).decode()
    end = program[len(program.rstrip()) :]
    return program[:start] + "\n".join(lines) + end


def _is_length(node: ast.Constant) -> bool:
    return isinstance(node.value, float) and 0 < node.value < LONGEST_M


def _candidates(tree: ast.AST) -> Iterator[tuple[ast.Constant, int | None, int | None]]:
    """Yield the constants in places where lengths stand, each with its axis and its side if they are known."""
    for node in ast.walk(tree):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
            for side, other in ((node.left, node.right), (node.right, node.left)):
                yield from ((constant, _axis_of(other), None) for constant in _constant(side))
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
            for side, other in ((node.left, node.right), (node.right, node.left)):
                if _is_direction(other):
                    yield from ((constant, None, _side_of(other)) for constant in _constant(side))
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
            yield from ((constant, None, None) for constant in _constant(node.left))
        elif isinstance(node, ast.List | ast.Tuple) and len(node.elts) == 3:
            for axis, element in enumerate(node.elts):
                yield from ((constant, axis, None) for constant in _constant(element))
        elif isinstance(node, ast.Compare) and len(node.comparators) == 1:
            yield from ((constant, _axis_of(node.left), None) for constant in _constant(node.comparators[0]))
        elif isinstance(node, ast.Assign):
            yield from ((constant, None, None) for constant in _constant(node.value))


def _constant(node: ast.expr) -> list[ast.Constant]:
    inner = node.operand if isinstance(node, ast.UnaryOp) else node
    return [inner] if isinstance(inner, ast.Constant) else []


def _is_direction(node: ast.expr) -> bool:
    """Check whether an expression looks like a vector that a length is multiplied by, rather than a cost."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name | ast.Attribute):
        name = node.func.id if isinstance(node.func, ast.Name) else node.func.attr
        return name in ("quat_axis", "array", "cross", "quat_rotate")
    return isinstance(node, ast.Name)


def _side_of(node: ast.expr) -> int | None:
    """Return k of `quat_axis(q, k)`; None for anything else."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "quat_axis":
        last = node.args[-1] if node.args else None
        if isinstance(last, ast.Constant) and isinstance(last.value, int):
            return last.value
    return None


def _axis_of(node: ast.expr) -> int | None:
    """Return the axis of a coordinate such as `self.box_pos[2]`, or of a sum of such; None if there is none."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        return _axis_of(node.left)
    if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant) and isinstance(node.slice.value, int):
        return None if isinstance(node.value, ast.Call) else node.slice.value  # a part of a direction is no length
    return None


def _express(length: Length, numbers: Mapping[str, float]) -> SizeExpression | None:
    if length.decimals > ROUND_DIGITS or length.side is not None:
        found = _share_of_size(length, numbers)
        if found is not None:
            return found
    return _stated(length, numbers) if length.decimals <= ROUND_DIGITS else None


def _stated(length: Length, numbers: Mapping[str, float]) -> SizeExpression | None:
    """Express a round length by a height or a place that the task states."""
    value = float(length.text)
    if length.axis == 2:
        for key, height in numbers.items():
            if key.startswith("goal.lifted.") and key.endswith(".height_m"):
                margin = round(value - height, 5)
                if 0 <= margin <= LIFT_MARGIN_M:
                    return SizeExpression(shares={key: 1.0}, margin_m=margin)
    for key, stated in numbers.items():
        if key.startswith("place.") and key.endswith(f".{length.axis}") and abs(stated - value) < 1e-6:
            return SizeExpression(shares={key: 1.0})
    return None


def _share_of_size(length: Length, numbers: Mapping[str, float]) -> SizeExpression | None:
    """Express a length by a share of a size and a margin; the simplest that fits."""
    value = float(length.text)
    within = (0.5 * 10.0**-length.decimals if length.decimals > ROUND_DIGITS else 0.0) + 1e-6
    places = {key: z for key, z in numbers.items() if key.startswith("place.") and key.endswith(".2") and z > 0}
    options: list[tuple[tuple[bool, float, int], SizeExpression]] = []

    def offer(key: str, rank: int, margin_m: float = 0.0, place: str = "") -> None:
        shares = {key: SHARES[rank], **({place: 1.0} if place else {})}
        simplicity = (bool(margin_m or place), abs(margin_m), rank)
        options.append((simplicity, SizeExpression(shares=shares, margin_m=round(margin_m, 5))))

    for key, size in numbers.items():
        if not _may_mean(key, size, length, numbers):
            continue
        for rank, share in enumerate(SHARES):
            margin = value - share * size
            if abs(margin) <= within:
                offer(key, rank)
            elif length.decimals <= ROUND_DIGITS:
                if share == 0.5 and any(abs(margin - known) <= within for known in HAND_MARGINS_M):
                    offer(key, rank, margin)
            elif share in (1.0, 0.5):
                nearest = min(MARGINS_M, key=lambda known: abs(known - abs(margin)))
                if abs(abs(margin) - nearest) <= within:
                    offer(key, rank, math.copysign(nearest, margin))
                for place, z in places.items():
                    if abs(margin - z) <= within:
                        offer(key, rank, place=place)
    return min(options, key=lambda option: option[0])[1] if options else None


def _may_mean(key: str, size: float, length: Length, numbers: Mapping[str, float]) -> bool:
    """Check whether a number of the scene is a size that a length of a program may be a share of."""
    thing, _, side = key.partition(".size.")
    if not side:
        return False
    if length.side is not None:
        return side == str(length.side) and _is_round(size) == (length.decimals <= ROUND_DIGITS)
    if length.axis == 2 and f"{thing}.up" in numbers:
        return side == str(int(numbers[f"{thing}.up"])) and not _is_round(size)  # a vertical extent
    return not _is_round(size)


def _is_round(size: float) -> bool:
    return abs(size - round(size, ROUND_DIGITS)) < 1e-9

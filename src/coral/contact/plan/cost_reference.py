"""Reference of the cost language as text: for a model's prompt, and for the tables of the reference page."""

from __future__ import annotations

from coral.contact.cost.context import Quantity, Schema
from coral.contact.cost.schema import HAND, object_quantities, scenery_quantities
from coral.contact.cost_program.errors import CODES
from coral.contact.cost_program.library import CONSTANTS, MATH, METHODS, NUMPY, OURS, PYTHON
from coral.contact.cost_program.pybullet import PyBullet
from coral.contact.cost_program.state import StateSpace


def interface(schema: Schema) -> str:
    """Describe what the function can use, for the prompt that asks a model for a cost.

    Args:
        schema: The quantities of the task.
    """
    bodies = ", ".join(f"self.{name}" for name in ("panda", *StateSpace(schema).objects))
    lines = ["Quantities, world frame, metres, z up, quaternions (w, x, y, z):"]
    lines += [f"- self.{name}: {_kind(item)}{_unit(item)}, {item.text}" for name, item in schema.items()]
    lines += [
        f"Functions: {', '.join(sorted(OURS))}; of Python {', '.join(sorted(PYTHON))}; np and math.",
        "sigmoid(x) is 1 / (1 + exp(-x)); near(d, s) is exp(-(d / s)^2); quat_angle(a, b) is the angle between "
        "two orientations in rad; quat_axis(q, i) is the world direction of body axis i = 0, 1 or 2.",
        f"PyBullet's {', '.join(PyBullet(StateSpace(schema)).calls)} are answered as p.NAME for {bodies}; "
        "they use (x, y, z, w).",
        'Return a number, or better a dict of named terms: return {"reach": 5.0 * dist(self.ee_pos, goal), ...}.',
    ]
    return "\n".join(lines)


def _kind(quantity: Quantity) -> str:
    if quantity.truth:
        return "true or false"
    return f"vector of {quantity.size}" if quantity.size else "number"


def _unit(quantity: Quantity) -> str:
    return f" ({quantity.unit})" if quantity.unit else ""


def _quantities(schema: Schema) -> str:
    rows = [
        f"| `self.{name}` | {_kind(q)} | {q.unit or '–'} | {q.text}{', constant' if q.constant else ''} |"
        for name, q in schema.items()
    ]
    return "\n".join(["| name | kind | unit | what |", "|---|---|---|---|", *rows, ""])


def _names(names: list[str]) -> str:
    return ", ".join(f"`{name}`" for name in sorted(names))


def _functions() -> str:
    rows = [
        ("ours", list(OURS)),
        ("Python", [*PYTHON, "dict", "print (ignored)"]),
        ("`np.`", list(NUMPY)),
        ("`math.`", list(MATH)),
        ("`np.`, `math.` constants", list({**CONSTANTS["np"], **CONSTANTS["math"]})),
        ("methods of arrays", list(METHODS)),
        ("`p.`", list(PyBullet(StateSpace(HAND)).calls)),
    ]
    lines = [f"| {where} | {_names(names)} |" for where, names in rows]
    return "\n".join(["| where | names |", "|---|---|", *lines, ""])


def _errors() -> str:
    lines = [f"| `{code}` | {text} |" for code, text in CODES.items()]
    return "\n".join(["| code | meaning |", "|---|---|", *lines, ""])


def tables() -> dict[str, str]:
    """Return the generated tables of the reference page by name."""
    box = object_quantities("box", ["handle"], ["table"], ["bottle"], "slide")
    scenery = scenery_quantities(["wall"], ["goal"], ["force"])
    return {
        "hand": _quantities(HAND),
        "object": _quantities(box),
        "scenery": _quantities(scenery),
        "functions": _functions(),
        "errors": _errors(),
    }

"""Tables of the cost language for its reference page."""

from __future__ import annotations

from coral.contact.cost.context import Quantity, Schema
from coral.contact.cost.schema import HAND, object_quantities, scenery_quantities
from coral.contact.cost_program.errors import CODES
from coral.contact.cost_program.library import CONSTANTS, MATH, METHODS, NUMPY, OURS, PYTHON


def _kind(quantity: Quantity) -> str:
    if quantity.truth:
        return "true or false"
    return f"vector of {quantity.size}" if quantity.size else "number"


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
        ("Python", list(PYTHON)),
        ("`np.`", list(NUMPY)),
        ("`math.`", list(MATH)),
        ("`np.`, `math.` constants", list({**CONSTANTS["np"], **CONSTANTS["math"]})),
        ("methods of arrays", list(METHODS)),
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

"""Extracting the program from a model's reply: fences, indentation, and prose before or after it."""

from __future__ import annotations

import re
import textwrap

FENCE = re.compile(r"^[ \t]*(```+|~~~+)[ \t]*([\w+-]*)[ \t]*$", re.MULTILINE)
DEFINITION = re.compile(r"^([ \t]*)(?:async[ \t]+)?def[ \t]+\w+[ \t]*\(", re.MULTILINE)
COST = re.compile(r"^[ \t]*(?:async[ \t]+)?def[ \t]+state_cost[ \t]*\(", re.MULTILINE)
NAMES = r"[A-Za-z_]\w*(\s*,\s*[A-Za-z_]\w*)*"
START = re.compile(rf"^(def|async|from|import|@|#|{NAMES}(\[.*\])?(\s*:\s*[\w\[\], ]+)?\s*([-+*/]?=)|\"\"\"|\'\'\')")
RULE = re.compile(r"^[ \t]*---+[ \t]*$", re.MULTILINE)
WRAPPED = "def state_cost(self):\n"


def extract(text: str) -> str:
    """Return the program in a model's reply, dedented, without fences and explanation.

    The reply is bare code, code in a fence, an indented block, code and an explanation separated by `---`, or the body
    of the function alone.
    """
    text = text.replace("\r\n", "\n").replace("\r", "\n").expandtabs(4)
    code = _fenced_code(text)
    if code is None:
        code, rule, start = text, RULE.search(text), DEFINITION.search(text)
        if rule and (start is None or rule.start() > start.start()):
            code = text[: rule.start()]
    return _dedent(code)


def _fenced_code(text: str) -> str | None:
    marks = list(FENCE.finditer(text))
    blocks = []
    while marks:
        opening = marks.pop(0)
        closing = next((m for m in marks if m.group(1)[0] == opening.group(1)[0] and not m.group(2)), None)
        end = closing.start() if closing else len(text)
        blocks.append(text[opening.end() : end])
        marks = [m for m in marks if closing and m.start() > closing.start()]
    if not blocks:
        return None
    return max(
        blocks, key=lambda block: (COST.search(block) is not None, DEFINITION.search(block) is not None, len(block))
    )


def _dedent(code: str) -> str:
    lines = code.strip("\n").split("\n")
    found = DEFINITION.search("\n".join(lines))
    if found is None:
        return _body(lines)
    first = "\n".join(lines)[: found.start()].count("\n")
    indent = len(found.group(1))
    while first > 0 and _belongs(lines[first - 1], indent):
        first -= 1
    kept = []
    for line in lines[first:]:
        bare = line.strip()
        depth = len(line) - len(line.lstrip())
        if bare and depth < indent:
            break
        if bare and depth == indent and not START.match(bare) and bare[0] not in ")]}":
            break
        kept.append(line[indent:])
    return "\n".join(kept).rstrip() + "\n"


def _belongs(line: str, indent: int) -> bool:
    """Check whether a line above the function is code rather than prose."""
    bare = line.strip()
    return not bare or (
        len(line) - len(line.lstrip()) >= indent
        and (START.match(bare) is not None or line[: indent + 1].strip() == "" or bare[0] in ")]}")
    )


def _body(lines: list[str]) -> str:
    """Turn statements without a `def` line into the function's body; the first line may have lost its indent."""
    if lines and lines[0].strip() and not lines[0].startswith(" "):
        rest = textwrap.dedent("\n".join(lines[1:]))
        joined = "\n".join(lines)
        body = joined if re.search(r"^\S", "\n".join(lines[1:]), re.MULTILINE) else f"{lines[0]}\n{rest}"
    else:
        body = textwrap.dedent("\n".join(lines))
    if not body.strip():
        return ""
    return WRAPPED + textwrap.indent(body.rstrip(), "    ") + "\n"

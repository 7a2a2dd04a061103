"""Names for the terms of a sum, from the comments and variables of the program."""

from __future__ import annotations

import ast
import contextlib
import io
import re
import tokenize

WEIGHT = re.compile(r"^(w|k|c|weight|gain|scale|alpha|beta|lambda|coef)(_|\d|$)|_(w|weight|gain|coef)$", re.IGNORECASE)
LONGEST = 40


class TermNames:
    """A name for every expression that is added to the cost.

    Args:
        source: The program.
    """

    def __init__(self, source: str) -> None:
        self.lines = source.split("\n")
        self.comments = _comments(source)
        self.names: dict[int, str] = {}
        self.line_of: dict[str, int] = {}

    def of(self, node: ast.expr, whole: bool, variable: str) -> str:
        """Return the name of an addend: the same for the same place in the program, different for different places.

        Args:
            node: The addend.
            whole: Whether its statement adds nothing else, so that the statement's comment describes it.
            variable: Variable that it is added to.
        """
        key = id(node)
        if key not in self.names:
            guess = (
                (self._trailing(node.lineno) if whole else "")
                or _variable(node, variable)
                or (self._above(node.lineno) if whole else "")
                or ("cost" if whole and not variable else f"line {node.lineno}")
            )
            guess = _shorten(guess)
            name, count = guess, 2
            while name in self.line_of:
                name, count = f"{guess} {count}", count + 1
            self.names[key] = name
            self.line_of[name] = node.lineno
        return self.names[key]

    def _trailing(self, line: int) -> str:
        return self.comments[line][1] if line in self.comments and not self.comments[line][0] else ""

    def _above(self, line: int) -> str:
        """Return the nearest comment line above, searching no further than the beginning of the function."""
        for number in range(line - 1, 0, -1):
            alone, text = self.comments.get(number, (False, ""))
            if alone and text:
                return text
            if self.lines[number - 1].lstrip().startswith("def "):
                break
        return ""


def _comments(source: str) -> dict[int, tuple[bool, str]]:
    """Map line numbers to comments: whether the comment has the line to itself, and its text."""
    found: dict[int, tuple[bool, str]] = {}
    with contextlib.suppress(tokenize.TokenError, SyntaxError):
        for token in tokenize.generate_tokens(io.StringIO(source).readline):
            if token.type == tokenize.COMMENT:
                found[token.start[0]] = (token.line.lstrip().startswith("#"), _clean(token.string))
    return found


def _clean(comment: str) -> str:
    text = "".join(c if c.isprintable() else " " for c in comment)
    return _shorten(" ".join(text.strip(" \t#-=*.:").split()))


def _shorten(text: str) -> str:
    return text if len(text) <= LONGEST else text[:LONGEST].rsplit(" ", 1)[0]


def _variable(node: ast.expr, variable: str) -> str:
    """Return the one variable that is scaled by constants and weights, as `reach` in `w_reach * reach`; else ""."""
    parts = _factors(node)
    if parts is None:
        return ""
    names = [name for name in parts if name != variable and not WEIGHT.search(name)]
    return names[0] if len(names) == 1 else ""


def _factors(node: ast.expr) -> list[str] | None:
    """Return the variables of a product of variables and constants; None for anything else."""
    if isinstance(node, ast.UnaryOp):
        return _factors(node.operand)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
        left, right = _factors(node.left), _factors(node.right)
        return None if left is None or right is None else left + right
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
        return _factors(node.left)
    if isinstance(node, ast.Constant):
        return []
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        return [node.attr]
    return [node.id] if isinstance(node, ast.Name) else None

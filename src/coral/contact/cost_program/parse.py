"""Parsing of program text into a syntax tree with only those parts of Python that costs need."""

from __future__ import annotations

import ast
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from coral.contact.cost_program.errors import CostError, line_of
from coral.contact.cost_program.extract import WRAPPED, extract
from coral.contact.cost_program.library import MODULE_NAMES
from coral.contact.cost_program.limits import MOST_CHARACTERS, MOST_DEPTH, MOST_NODES

# fmt: off
ALLOWED: frozenset[type[ast.AST]] = frozenset((
    ast.Module, ast.FunctionDef, ast.arguments, ast.arg, ast.Return, ast.Assign, ast.AugAssign, ast.AnnAssign,
    ast.For, ast.If, ast.Expr, ast.Pass, ast.Break, ast.Continue, ast.Import, ast.alias, ast.BoolOp, ast.BinOp,
    ast.UnaryOp, ast.Lambda, ast.IfExp, ast.Dict, ast.ListComp, ast.GeneratorExp, ast.comprehension, ast.Compare,
    ast.Call, ast.keyword, ast.Constant, ast.Attribute, ast.Subscript, ast.Name, ast.List, ast.Tuple, ast.Slice,
    ast.Load, ast.Store, ast.And, ast.Or, ast.Not, ast.USub, ast.UAdd, ast.Add, ast.Sub, ast.Mult, ast.Div,
    ast.FloorDiv, ast.Mod, ast.Pow, ast.MatMult, ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE,
))
# fmt: on
WORDS: dict[type[ast.AST], str] = {
    ast.With: "with (leave it out)",
    ast.ClassDef: "classes (write functions)",
    ast.Global: "global (return the value instead)",
    ast.Nonlocal: "nonlocal (return the value instead)",
    ast.Raise: "raise (return a large cost instead)",
    ast.Delete: "del (leave it out)",
    ast.Assert: "assert (leave it out)",
    ast.Yield: "yield (return a list)",
    ast.YieldFrom: "yield (return a list)",
    ast.Await: "await",
    ast.AsyncFunctionDef: "async (write def without it)",
    ast.Match: "match (write if and elif)",
    ast.While: "while (write `for i in range(N):` with `if not condition: break`)",
    ast.Try: "try (leave it out, and write max, min or np.where around what may fail)",
    ast.TryStar: "try (leave it out, and write max, min or np.where around what may fail)",
    ast.Set: "sets (write a list)",
    ast.SetComp: "sets (write a list)",
    ast.NamedExpr: "`:=` (write the assignment on a line of its own)",
    ast.Invert: "~ (write not)",
    ast.BitAnd: "& (write and)",
    ast.BitOr: "| (write or)",
    ast.Is: "`is` (write ==)",
    ast.IsNot: "`is not` (write !=)",
    ast.In: "`in` outside a for (write == and or)",
    ast.NotIn: "`not in` (write != and and)",
    ast.DictComp: "dicts of a comprehension (write the entries one by one)",
    ast.Starred: "`*` (write the values one by one)",
    ast.ImportFrom: "`from` (write np.NAME or math.NAME; for rotations quat_angle, quat_axis and quat_rotate)",
    ast.JoinedStr: "f-strings (write the text itself)",
}
BRACKETS = 60


@dataclass(frozen=True)
class Parsed:
    """A program that passed the checks."""

    source: str
    """Its text; line numbers refer to it."""
    tree: ast.Module
    """Its module."""
    entry: ast.FunctionDef
    """The cost function."""
    own_names: Mapping[int, frozenset[str]]
    """Names that the module and each function set, by the identity of its node."""
    attributes: frozenset[str]
    """Names after a dot."""


@lru_cache(maxsize=64)  # a plan is compiled for its check and again for its use
def parse(text: str) -> Parsed:
    """Parse and check a program; programs of the same text share what is returned.

    Raises:
        CostError: It is too large, is not Python, or uses a part of Python that costs do not have.
    """
    if len(text) > MOST_CHARACTERS:
        raise CostError("too_large", f"a cost has at most {MOST_CHARACTERS} characters, this reply has {len(text)}")
    source = extract(text)
    if not source.strip():
        raise CostError("empty", "the reply holds no code; answer with `def state_cost(self):`")
    _check_nesting(source)
    try:
        tree = _tree(source)
    except CostError:
        if "def " not in source.replace(WRAPPED, "") and "=" not in source and "return" not in source:
            raise CostError("no_function", "the reply holds no code; answer with `def state_cost(self):`") from None
        raise
    try:
        _check(tree, source)
    except RecursionError:
        raise CostError("too_large", "the program is nested too deeply") from None
    nodes = list(ast.walk(tree))
    scopes = {id(node): own_names(node.body) for node in nodes if isinstance(node, ast.Module | ast.FunctionDef)}
    attributes = frozenset(node.attr for node in nodes if isinstance(node, ast.Attribute))
    return Parsed(source, tree, _entry(tree), scopes, attributes)


def own_names(body: list[ast.stmt]) -> frozenset[str]:
    """Return the names that a function sets, excluding functions and comprehensions inside it."""
    found: set[str] = set()
    pending: list[ast.AST] = list(body)
    while pending:
        node = pending.pop()
        if isinstance(node, ast.FunctionDef):
            found.add(node.name)
            continue
        if isinstance(node, ast.Lambda | ast.ListComp | ast.GeneratorExp):
            continue
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
        if isinstance(node, ast.alias):
            found.add(node.asname or node.name)
        pending.extend(ast.iter_child_nodes(node))
    return frozenset(found)


def _check_nesting(source: str) -> None:
    """Reject nesting that would exhaust Python's own parser."""
    depth = 0
    for number, line in enumerate(source.split("\n"), 1):
        for character in line:
            depth += (character in "([{") - (character in ")]}")
            if depth > BRACKETS:
                raise CostError("too_large", f"more than {BRACKETS} brackets inside one another", number)
            if character == "\0":
                raise CostError("syntax", "a zero byte", number)


def _tree(source: str) -> ast.Module:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(source)
    except SyntaxError as error:
        line = error.lineno or 0
        raise CostError("syntax", f"not Python: {error.msg}", line, line_of(source, line)) from None
    except (RecursionError, MemoryError):
        raise CostError("too_large", "the program is nested too deeply") from None
    except (ValueError, OverflowError):
        raise CostError("syntax", "not Python: it holds characters or numbers that cannot be read") from None


def _check(tree: ast.Module, source: str) -> None:
    pending: list[tuple[ast.AST, int, int]] = [(tree, 0, 1)]
    count = 0
    while pending:
        node, depth, line = pending.pop()
        line = getattr(node, "lineno", line)
        count += 1
        try:
            if count > MOST_NODES:
                raise CostError("too_large", f"a cost has at most {MOST_NODES} syntax nodes", line)
            if depth > MOST_DEPTH:
                raise CostError("too_large", f"more than {MOST_DEPTH} levels of nesting; use more variables", line)
            _check_node(node, line)
        except CostError as error:
            raise CostError(error.code, error.text, error.line, line_of(source, error.line)) from None
        chain = isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub)
        for child in ast.iter_child_nodes(node):
            if isinstance(node, ast.arg | ast.FunctionDef) and child is getattr(node, "annotation", None):
                continue
            if child is getattr(node, "returns", None) or (
                isinstance(node, ast.AnnAssign) and child is node.annotation
            ):
                continue
            flat = chain and isinstance(node, ast.BinOp) and child is node.left
            pending.append((child, depth if flat else depth + 1, line))


def _check_node(node: ast.AST, line: int) -> None:
    if type(node) not in ALLOWED:
        word = WORDS.get(type(node), f"`{type(node).__name__}`")
        raise CostError("not_allowed", f"a cost has no {word}", line)
    for name in _names(node):
        if "__" in name:
            raise CostError("not_allowed", f"names with two underscores, as {name!r}, are not available", line)
    if isinstance(node, ast.FunctionDef) and node.decorator_list:
        raise CostError("not_allowed", "a cost has no decorators; leave them out", line)
    if isinstance(node, ast.FunctionDef | ast.Lambda):
        _check_arguments(node.args, line)
    elif isinstance(node, ast.Constant):
        _check_constant(node, line)
    elif isinstance(node, ast.Import):
        _check_import(node, line)
    elif isinstance(node, ast.comprehension) and node.is_async:
        raise CostError("not_allowed", "a cost has no async", line)
    elif isinstance(node, ast.For):
        _check_loop(node, line)


def _names(node: ast.AST) -> list[str]:
    found = [getattr(node, key, None) for key in ("id", "attr", "arg", "name", "asname")]
    return [name for name in found if isinstance(name, str)]


def _check_arguments(arguments: ast.arguments, line: int) -> None:
    if arguments.vararg or arguments.kwarg or arguments.kwonlyargs or arguments.posonlyargs:
        raise CostError("not_allowed", "a cost has no `*` and `/` in definitions; name the arguments", line)


def _check_loop(node: ast.For, line: int) -> None:
    if node.orelse:
        raise CostError("not_allowed", "a cost has no else after a loop; set a variable in it", line)
    read = {part.id for part in ast.walk(node.iter) if isinstance(part, ast.Name)}
    for part in ast.walk(node):
        held = part.value if isinstance(part, ast.Subscript) and isinstance(part.ctx, ast.Store) else None
        if isinstance(held, ast.Name) and held.id in read:
            raise CostError("shared", f"{held.id!r} changes in a loop over it; fill another dict", held.lineno)


def _check_constant(node: ast.Constant, line: int) -> None:
    value = node.value
    if not (value is None or isinstance(value, bool | int | float | str)):
        raise CostError("not_allowed", f"a cost has no {type(value).__name__} constants", line)
    if isinstance(value, int) and abs(value) > 2**53:
        raise CostError("too_large_number", "whole numbers reach to 2**53", line)


def _check_import(node: ast.Import, line: int) -> None:
    for alias in node.names:
        if alias.name not in MODULE_NAMES:
            raise CostError("not_allowed", f"{alias.name!r} cannot be imported; np and math are there already", line)


def _entry(tree: ast.Module) -> ast.FunctionDef:
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    named = [node for node in functions if node.name == "state_cost"]
    found = named[-1] if named else functions[0] if len(functions) == 1 else None
    if found is None:
        raise CostError("no_function", "there is no `def state_cost(self):`")
    arguments = found.args
    if not arguments.args or len(arguments.args) - len(arguments.defaults) > 1:
        raise CostError("no_function", f"{found.name} takes one argument: `def state_cost(self):`", found.lineno)
    return found

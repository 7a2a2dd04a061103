"""The flags of a command: its dataclass, or a configuration, read as a list of plain values.

A field is a flag; a field that is itself a dataclass is a group of flags, `--GROUP.KEY`. Help, completion, the list of
the configuration and the parser all read this list.
"""

from __future__ import annotations

import ast
import dataclasses
import inspect
import sys
import types
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from coral.foreign_file import read_text

MANY = -1
"""Number of words of a flag that takes any number of them."""
NUMBERS = {int: "INT", float: "FLOAT"}


@dataclass(frozen=True, kw_only=True)
class Option:
    """How a field appears on the command line; stands in `Annotated[...]`."""

    metavar: str = ""
    """What stands for the value in the help; by default its type. In brackets, any number of words may be none."""
    help: str = ""
    """Text instead of the docstring below the field."""
    name: str | None = None
    """Name instead of the field's; "" makes the flags of a group flags of the command."""
    repeated: bool = False
    """Whether the flag is given once for each value."""
    hidden: bool = False
    """Whether it is no flag at all, but set by the program."""
    names: Iterable[str] | Callable[[], Iterable[str]] = ()
    """Values that completion offers."""


def forms_text(forms: Mapping[str, str]) -> str:
    """List the forms of a flag's value with what each is, for its help."""
    return "; or ".join(f"{form}, {what}" for form, what in forms.items())


@dataclass(frozen=True, kw_only=True)
class Argument(Option):
    """A field that is given by its place among the words, without a flag."""


@dataclass(frozen=True, kw_only=True)
class Flag:
    """One flag, or one argument, as plain values."""

    name: str
    """`--cfg.time-limit-s`; the metavar of an argument."""
    field: tuple[str, ...]
    """Names of the fields that lead to it in the dataclass."""
    metavar: str
    """What stands for the value; "" for yes and no."""
    words: int
    """Number of words that follow: 0 for yes and no, `MANY` for any number."""
    repeated: bool
    positional: bool
    required: bool
    optional: bool
    """Whether the word None is accepted."""
    default: str
    """As it would be typed; "" if there is none."""
    text: str
    type: str
    """What is accepted, in words: "a number > 0"."""
    names: tuple[str, ...]

    @property
    def spellings(self) -> tuple[str, ...]:
        """Return the words that select it: yes and no have two; an argument has none."""
        if self.positional:
            return ()
        group, dot, last = self.name.removeprefix("--").rpartition(".")
        return (self.name,) if self.words else (self.name, f"--{group}{dot}no-{last}")


@dataclass(frozen=True, kw_only=True)
class FlagGroup:
    """A configuration among the flags of a command."""

    prefix: str
    """`--cfg`."""
    place: str
    """`module:class` of the configuration."""
    text: str


@dataclass(frozen=True, kw_only=True)
class Described:
    """A command, or a configuration."""

    text: str
    flags: tuple[Flag, ...]
    groups: tuple[FlagGroup, ...]


def describe(kind: type) -> Described:
    """Describe a command's dataclass or a configuration."""
    flags: list[Flag] = []
    groups: list[FlagGroup] = []
    _walk(kind, MISSING, "--", (), flags, groups)
    return Described(text=class_doc(kind), flags=tuple(flags), groups=tuple(groups))


def _walk(
    kind: type, instance: Any, prefix: str, path: tuple[str, ...], flags: list[Flag], groups: list[FlagGroup]
) -> None:
    hints, docs = get_type_hints(kind, include_extras=True), field_docs(kind)
    for field in dataclasses.fields(kind):
        base, option, bounds, optional = taken_apart(hints[field.name])
        nested = get_origin(base) is tuple and any(get_origin(item) is tuple for item in get_args(base))
        if option.hidden or nested or not field.init:  # nested tuples have no spelling as words
            continue
        default = field.default if instance is MISSING else getattr(instance, field.name)
        if default is MISSING and field.default_factory is not MISSING:
            default = field.default_factory()
        here, text = (*path, field.name), option.help or docs.get(field.name, "")
        name = field.name.replace("_", "-") if option.name is None else option.name
        if dataclasses.is_dataclass(base) and isinstance(base, type):
            if name:
                place = f"{base.__module__}:{base.__qualname__}"
                groups.append(FlagGroup(prefix=f"{prefix}{name}", place=place, text=text or class_doc(base)))
            _walk(base, default, f"{prefix}{name}." if name else prefix, here, flags, groups)
            continue
        positional = isinstance(option, Argument)
        # `coral.config.checked` refuses negative numbers in a configuration whose type states no range.
        from_zero = [types.SimpleNamespace(ge=0)] if base in NUMBERS and "__call__" not in vars(kind) else []
        metavar = option.metavar or _metavar(base)
        names = tuple(option.names() if callable(option.names) else option.names)
        flags.append(
            Flag(
                name=(option.metavar or name.upper()) if positional else f"{prefix}{name}",
                field=here,
                metavar=metavar,
                words=1 if option.repeated else _words(base),
                repeated=option.repeated,
                positional=positional,
                required=default is MISSING,
                optional=optional,
                default="" if default is MISSING else shown(default),
                text=text,
                type=_type(base, bounds or from_zero, optional and default is not None),
                names=names or (get_args(base) if get_origin(base) is Literal else ()),
            )
        )


def taken_apart(hint: Any) -> tuple[Any, Option, tuple[Any, ...], bool]:
    """Return type, option, bounds and whether None is allowed, of the type of a field."""
    bounds: list[Any] = []
    option, optional = Option(), False
    while True:
        if get_origin(hint) is Annotated:
            for mark in hint.__metadata__:
                if isinstance(mark, Option):
                    option = mark
                else:
                    bounds += getattr(mark, "metadata", [])
            hint = hint.__origin__
        elif get_origin(hint) in (Union, types.UnionType):
            optional = True
            (hint,) = (each for each in get_args(hint) if each is not type(None))
        else:
            return hint, option, tuple(bounds), optional


def shown(value: Any) -> str:
    """Format a value as it would be typed after its flag."""
    if value is None or value == () or value == "":
        return ""
    if isinstance(value, tuple):
        return " ".join(map(shown, value))
    if isinstance(value, float) and abs(float(f"{value:g}") - value) <= 1e-9 * abs(value):
        return f"{value:g}"
    return str(value)


def _items(base: Any) -> tuple[Any, ...]:
    """Return the types of a tuple's items; () for a tuple of any length."""
    items = get_args(base)
    return () if Ellipsis in items else tuple(taken_apart(item)[0] for item in items)


def _words(base: Any) -> int:
    if base is bool:
        return 0
    return (len(_items(base)) or MANY) if get_origin(base) is tuple else 1


def _metavar(base: Any) -> str:
    if base is bool:
        return ""
    if get_origin(base) is Literal:
        return "|".join(map(str, get_args(base)))
    if get_origin(base) is tuple:
        return " ".join(map(_metavar, _items(base))) or f"{_metavar(taken_apart(get_args(base)[0])[0])}..."
    return NUMBERS.get(base) or str(base.__name__).upper()


def _type(base: Any, bounds: Sequence[Any], optional: bool) -> str:
    """Say what is accepted: "a number > 0, <= 1"."""
    limits = [
        f"{sign} {limit:g}"
        for bound in bounds
        for name, sign in (("gt", ">"), ("ge", ">="), ("lt", "<"), ("le", "<="))
        if (limit := getattr(bound, name, None)) is not None
    ]
    if get_origin(base) is Literal:
        what = f"one of {', '.join(map(str, get_args(base)))}"
    elif get_origin(base) is tuple:
        item, _, inner, _ = taken_apart(get_args(base)[0])
        what = f"{len(_items(base)) or 'any number of'} values, each {_type(item, inner, False)}"
    else:
        what = {bool: "yes or no", int: "a whole number", float: "a number", Path: "a path"}.get(base, "a text")
    return " ".join([what, ", ".join(limits)]).strip() + (", or None" if optional else "")


def field_docs(kind: type) -> dict[str, str]:
    """Return the text of each field of a class and of the classes that it extends, in one line each.

    A field without a docstring has no entry. Source: the file of the class; nothing is executed.
    """
    found: dict[str, str] = {}
    for each in reversed(kind.__mro__):
        found |= _docs_in(each.__module__).get(each.__qualname__, {})
    return found


def class_doc(kind: type) -> str:
    """Return the first paragraph of a class's docstring in one line."""
    return " ".join(inspect.cleandoc(kind.__doc__ or "").partition("\n\n")[0].split())


@cache
def _docs_in(module: str) -> dict[str, dict[str, str]]:
    """Return the texts of the fields by class of a module."""
    path = getattr(sys.modules.get(module), "__file__", None)
    if not path or not path.endswith(".py"):
        return {}
    tree = ast.parse(read_text(Path(path), "a module"))
    return {node.name: _docs_of(node) for node in ast.walk(tree) if isinstance(node, ast.ClassDef)}


def _docs_of(node: ast.ClassDef) -> dict[str, str]:
    found: dict[str, str] = {}
    for field, below in zip(node.body, node.body[1:], strict=False):
        if not (isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)):
            continue
        if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant) and isinstance(below.value.value, str):
            found[field.target.id] = " ".join(below.value.value.split())
    return found

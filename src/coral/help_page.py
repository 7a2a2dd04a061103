"""What `coral COMMAND --help` prints: a line for each flag of the command's own, and where the others are listed."""

from __future__ import annotations

import re
import shutil
import textwrap

from coral.errors import InputError, nearest
from coral.flags import MANY, Described, Flag
from coral.surface import configuration_at

WIDTH = 120
FITS = 45
"""A command with at most this many flags shows all of them; else `coral config` lists those of its configurations."""
NAMES_WIDTH = 34
_SENTENCE_END = re.compile(r"(?<=\.)(?<!Eq\.)(?<!Fig\.)(?<!Sec\.)(?<!Tab\.)(?<!e\.g\.)(?<!i\.e\.)\s+(?=[A-Z`\d-])")


def help_page(command: str, described: Described, width: int = 0) -> str:
    """Return the help of a command such as "reef run", in lines of a width, by default the terminal's, or 120."""
    width = width or shutil.get_terminal_size((WIDTH, 24)).columns
    groups = {group.prefix: group for group in described.groups if configuration_at(group.place)}
    groups = {} if len(described.flags) <= FITS else groups
    rows: dict[str, str] = {}
    for flag in sorted(described.flags, key=lambda flag: not flag.positional):
        group = groups.get(f"--{flag.field[0].replace('_', '-')}")
        if group is None:
            rows[_spelled(flag)] = summary(flag)
        else:
            lists = f"coral config {configuration_at(group.place)} lists them"
            rows[f"{group.prefix}.KEY VALUE"] = f"{lists}: {first_sentence(group.text)}"
    arguments = [flag.name for flag in described.flags if flag.positional]
    column = min(NAMES_WIDTH, max(map(len, rows))) + 2
    return "\n".join(
        [
            " ".join(["usage: coral", command, *arguments, "[flags]"]),
            "",
            textwrap.fill(described.text, width),
            "",
            *(_row(name, text, column, width) for name, text in rows.items()),
            "",
            f"One flag in full: coral {command} --help FLAG",
        ]
    )


def flag_page(command: str, described: Described, word: str) -> str:
    """Return all about one flag or argument of a command.

    Raises:
        InputError: The command has no such flag.
    """
    known = {name: flag for flag in described.flags for name in (flag.name, *flag.spellings)}
    name = word.partition("=")[0].replace("_", "-")
    flag = known.get(word) or known.get(name) or known.get(f"--{name}") or known.get(word.upper())
    if flag is None:
        raise InputError(f"coral {command} --help", "", repr(word), f"one of its flags{nearest(word, known)}")
    lines = [_spelled(flag), textwrap.fill(flag.text, WIDTH, initial_indent="  ", subsequent_indent="  ")]
    lines += [f"  accepted: {flag.type}"]
    lines += [f"  names: {', '.join(flag.names)}"] if flag.names and not flag.type.startswith("one of") else []
    lines += [f"  default: {flag.default}"] if flag.default else []
    return "\n".join(line for line in lines if line.strip())


def summary(flag: Flag) -> str:
    """Return the first sentence about a flag, and its default."""
    default = "" if not flag.words or flag.repeated or not flag.default else f" ({flag.default})"
    text = first_sentence(flag.text)
    return text.removesuffix(".") + default if default not in (f" ({word})" for word in text.split()) else text


def first_sentence(text: str) -> str:
    """Return a text up to the end of its first sentence."""
    return _SENTENCE_END.split(text, maxsplit=1)[0]


def _spelled(flag: Flag) -> str:
    if flag.positional:
        return flag.name
    if not flag.words:
        return f"--[no-]{flag.name[2:]}" if flag.default == "True" else flag.name
    return f"{flag.name} {flag.metavar}" if flag.words != MANY else f"{flag.name} {flag.metavar.removesuffix('...')}..."


def _row(name: str, text: str, column: int, width: int) -> str:
    line = f"  {name:<{column}}{text}".rstrip()
    return line if len(line) <= width else f"{line[: width - 1].rstrip()}…"

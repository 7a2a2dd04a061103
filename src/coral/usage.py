"""Complaints of the command-line parser, in one line like all other bad input."""

from __future__ import annotations

import re

from coral.errors import InputError

NUMBERS = {"INT": "a whole number", "FLOAT": "a number"}


def usage_error(command: str, complaint: str) -> InputError:
    """Convert tyro's complaint, a page in a box, to one error with the flag, the value found and the value expected.

    Args:
        command: The words that selected the command, such as "reef run".
        complaint: The text printed by tyro.
    """
    where, flags = f"coral {command}", f"flags as in: coral {command} --help"
    plain = re.sub(r"\x1b\[[0-9;]*m", "", complaint)  # a terminal gets colours
    text = " ".join(re.sub(r"[╭╮╰╯│─]+", " ", plain).split())
    text = re.split(r" For full helptext,", text)[0]
    if match := re.search(r"Unrecognized options: (\S+?),?(?: |$)", text):
        found = f"an unknown flag {match[1]}" if match[1].startswith("-") else f"a word too many, {match[1]!r}"
        meant = re.search(r"Perhaps you meant: (--\S+)", text)
        return InputError(where, "", found, f"{flags}{f' (did you mean {meant[1]!r}?)' if meant else ''}")
    if match := re.search(r"Missing value for argument '([^']+)'", text):
        return InputError(where, _flag_name(match[1]), "nothing", f"a value: {flags}")
    if match := re.search(r"Missing from [^:]+: (\S+) (.*?)(?: \(required\)|$)", text):
        return InputError(where, match[1], "nothing", match[2].rstrip("."))
    if match := re.search(r"invalid choice (.+?) for argument '([^']+)'\. Expected one of \((.*?),?\)", text):
        options = sorted(re.findall(r"'([^']*)'", match[3]))  # tyro lists them in any order
        return InputError(
            where, _flag_name(match[2]), match[1], f"one of {', '.join(o for o in options if o != 'None')}"
        )
    if match := re.search(r"Error parsing \S+: (.+?): found (.+), expected (.+)$", text):  # a configuration's own text
        return InputError(where, f"--cfg.{'.'.join(match[1].split(': '))}", match[2], match[3].strip())
    if match := re.search(r"Error parsing (\S+): (.*?)(?: Argument helptext: (\S+) (\S+)|$)", text):
        values = re.findall(r"'([^']*)'", match[2])
        kind = next((kind for kind in NUMBERS if kind in f"{match[2]} {match[4]}".split("|")[-1]), "")
        kind = kind or next((kind for kind in NUMBERS if kind.lower() in match[2]), "")
        found = repr(values[-1]) if values else match[2]
        return InputError(where, _flag_name(match[1]), found, NUMBERS.get(kind, f"a value: {flags}"))
    return InputError(where, "", re.sub(r"^(.+?) \1", r"\1", text), flags)


def _flag_name(argument: str) -> str:
    """Format an argument as `--help` shows it: positional ones in capitals."""
    return argument if argument.startswith("-") else argument.upper()

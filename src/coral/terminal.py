"""Lines that fit the terminal: words are not torn at its edge. Pipes and files get lines as they are."""

from __future__ import annotations

import os
import re
import textwrap
from typing import TextIO

NARROWEST = 20
_COLUMNS = re.compile(r"\S {2,}\S.* {2,}\S|^\s*\|")
"""Rows of tables are not wrapped: their columns would no longer stand below each other."""


def fitted(text: str, stream: TextIO) -> str:
    """Wrap the lines of a text at a terminal's width; rows of tables and anything but a terminal stay as they are."""
    try:
        width = os.get_terminal_size(stream.fileno()).columns if stream.isatty() else 0
    except (OSError, ValueError):
        width = 0
    if width < NARROWEST:
        return text
    return "\n".join(_wrapped(line, width) for line in text.split("\n"))


def _wrapped(line: str, width: int) -> str:
    if len(line) <= width or _COLUMNS.search(line):
        return line
    indent = line[: len(line) - len(line.lstrip())]
    return textwrap.fill(
        line.strip(),
        width,
        initial_indent=indent,
        subsequent_indent=f"{indent}  ",
        break_long_words=False,
        break_on_hyphens=False,
    )

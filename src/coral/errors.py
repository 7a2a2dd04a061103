"""The exception for a user's mistakes: file, field, value found, value expected."""

from __future__ import annotations

import contextlib
import difflib
import errno
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EROFS)
"""Errors of a full disk."""
MALFORMED = (ValueError, TypeError, KeyError, IndexError, AttributeError, OverflowError, RecursionError)
"""What taking a foreign value apart raises where it is of another kind, or a number beyond all floats."""
LONGEST = 60
"""Maximum number of characters shown of a wrong value."""


class InputError(ValueError):
    """Bad input from the user. The command line prints it as one line and exits with `ExitCode.BAD_INPUT`.

    `where` is the file, folder or flag with the bad value, `field` its dotted path in it, or "" if all of it is bad.
    Without what was expected, `found` is a sentence that says it all.
    """

    def __init__(self, where: str, field: str, found: object, expected: str) -> None:
        self.where, self.field, self.found, self.expected = str(where), field, found, expected
        place = f"{where}: {field}" if field else str(where)
        what = f"found {found}, expected {expected}" if expected else f"{found}"
        super().__init__(without_password(" ".join(f"{place}: {what}".split())))


class RunError(RuntimeError):
    """A run that was well specified but could not finish. Printed as one line; `ExitCode.FAILED`."""

    def __init__(self, text: object = "") -> None:
        super().__init__(without_password(str(text)))


def without_password(text: str) -> str:
    """Mask name and password in the addresses of a text, and the password of a GStreamer pipeline."""
    return _PASSWORD.sub("***", text) if "://" in text or "user-pw" in text else text


_PASSWORD = re.compile(r"""(?<=://)[^\s/"<>]+(?=@)|(?<=user-pw=)[^\s!]+""")


@contextlib.contextmanager
def naming(path: Path) -> Iterator[None]:
    """Add the file's name to an error of writing it; errors of `write` lack it."""
    try:
        yield
    except OSError as error:
        if error.filename is None and error.errno is not None:
            raise OSError(error.errno, error.strerror, str(path)) from None
        raise


def first_line(error: BaseException) -> str:
    """Return the first line of its text; some have none, such as MemoryError."""
    return next(iter(str(error).splitlines()), type(error).__name__)


def nearest(word: str, known: Iterable[str], likeness: float = 0.5) -> str:
    """Suggest a correction: " (did you mean 'x'?)", or "" if no known word is as similar as `likeness`, 0 to 1."""
    close = difflib.get_close_matches(word, list(known), n=1, cutoff=likeness)
    return f" (did you mean {close[0]!r}?)" if close else ""


def install_extra(name: str) -> str:
    """Return how to install an extra of the package, which no index has."""
    return f"the extra {name}: in a checkout of coral, pip install -e '.[{name}]'"


def shown(value: Any) -> str:
    """Shorten a wrong value for a message."""
    text = repr(value)
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."

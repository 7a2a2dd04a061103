"""What people read while a command works: standard error, because standard output belongs to its result."""

from __future__ import annotations

import sys


def tell(text: object) -> None:
    """Print a text at once."""
    print(text, file=sys.stderr, flush=True)

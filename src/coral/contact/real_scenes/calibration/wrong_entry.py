"""Refuses a fit that leaves too much, and finds the one entry that spoils it: without it, the others agree."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from coral.errors import InputError


def check_fit(
    residual: Callable[[Sequence[int]], float], count: int, limit: float, unit: str, least: int, place: tuple[str, str]
) -> None:
    """Check what a fit of `count` entries leaves, as `residual` returns it when it fits some of them, `least` or more.

    `place` is the file and field of the entries, for errors.

    Raises:
        InputError: It is more than the limit. If all is well without a certain one, it is named.
    """
    left = residual(range(count))
    if left <= limit:
        return
    where, field = place
    found = f"a residual of {left:.1f} {unit}"
    if count > least:
        best, wrong = min((residual([i for i in range(count) if i != k]), k) for k in range(count))
        if best <= limit:
            field = f"{field}[{wrong}]"
            found = f"{found}; without it the others agree: it is of another place"
    raise InputError(where, field, found, f"{limit:g} {unit}")

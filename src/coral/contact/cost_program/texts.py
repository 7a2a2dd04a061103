"""Texts: the keys of terms, built from constants."""

from __future__ import annotations

import re

from coral.contact.cost_program.limits import Meter
from coral.contact.cost_program.values import Value, kind

LONGEST_TEXT = 200
SPEC = re.compile(r"[<>^]?[+ ]?0?[0-9]{0,2}(\.[0-9])?[dfegs%]?")


def joined_text(meter: Meter, parts: list[Value]) -> str:
    """Join texts.

    Raises:
        CostError: The result is too long.
    """
    found = "".join(part for part in parts if isinstance(part, str))
    if len(found) > LONGEST_TEXT:
        raise meter.fault("memory", f"a text that is put together has at most {LONGEST_TEXT} characters")
    return found


def formatted(meter: Meter, value: Value, conversion: int, spec: Value) -> str:
    """Format a constant inside an f-string.

    Raises:
        CostError: It depends on the state, or does not fit the format.
    """
    if not isinstance(value, str | int | float):
        raise meter.fault("wrong_type", f"an f-string holds constant texts and numbers, not {kind(value)}")
    if conversion not in (-1, ord("s")) or not isinstance(spec, str) or not SPEC.fullmatch(spec):
        raise meter.fault("not_allowed", "an f-string takes a plain format, as {i} or {x:.2f}")
    try:
        return joined_text(meter, [format(value, spec)])
    except (ValueError, TypeError):
        raise meter.fault("wrong_type", f"{kind(value)} cannot be written as {spec!r}") from None

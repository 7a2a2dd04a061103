"""Functions of the user's own: one decides when the advisor is asked, another refuses answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from coral.advisor.question import Question, Rejection
from coral.errors import InputError
from coral.plugins import named_plugin

CODE = "own"
"""Code of a refusal that gives only a text."""


@dataclass(frozen=True, kw_only=True)
class TriggerMoment:
    """What a trigger's function sees: the robot's own estimates at one control tick."""

    t: float
    """Simulated time (s)."""
    x: float
    """Estimated position (m, world)."""
    y: float
    """Estimated position (m, world)."""
    speed: float
    """Speed (m/s)."""
    target: tuple[float, float] | None
    """Active goal (m, world)."""
    soon: bool | None
    """Whether the goals will be done before an answer can come; None if the variant does not ask ahead."""
    since_asked_s: float
    """Time since the last question (s); infinite before the first."""


Wanted = Callable[[TriggerMoment], bool]
"""Returns whether to ask now, in place of the distance to the goal in Eq. 12."""
Check = Callable[[Question[Any], Any], Rejection | str | None]
"""Returns why an answer is refused, in words for the advisor, or None."""
Verifier = Callable[[Question[Any], Any], Rejection | None]


def find_trigger(wanted: Wanted | str | None) -> Wanted | None:
    """Return the function that decides when the advisor is asked; None for Eq. 12.

    Args:
        wanted: The function, or the name of an entry point of the group `coral.triggers`.

    Raises:
        InputError: There is no such entry point, or it is no function.
    """
    found: Wanted | None = _own(wanted, "trigger", "a function of a TriggerMoment")
    return found


def find_verifier(verifier: Check | str | None) -> Verifier | None:
    """Return a check that always gives a `Rejection` or None; None without one.

    Args:
        verifier: The function, or the name of an entry point of the group `coral.verifiers`.

    Raises:
        InputError: There is no such entry point, or it is no function.
    """
    check: Check | None = _own(verifier, "verifier", "a function of a question and an answer")
    if check is None:
        return None

    def verify(question: Question[Any], answer: Any) -> Rejection | None:
        refusal = check(question, answer)
        return Rejection(code=CODE, reason=refusal) if isinstance(refusal, str) else refusal

    return verify


def _own(given: Any, part: str, expected: str) -> Any:
    found = named_plugin(f"coral.{part}s", given, f"--{part}") if isinstance(given, str) else given
    if found is not None and not callable(found):
        raise InputError(f"--{part}", "", repr(found), expected)
    return found

"""A check of answers that a caller or another package adds to those of the planner."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from coral.advisor.question import Question, Rejection
from coral.errors import InputError
from coral.plugins import named_plugin

CODE = "own"
"""Code of a refusal that gives only a text."""
Check = Callable[[Question[Any], Any], Rejection | str | None]
"""Returns why an answer is refused, in words for the advisor, or None."""
Verifier = Callable[[Question[Any], Any], Rejection | None]


def find_verifier(verifier: Check | str, where: str = "--verifier") -> Verifier:
    """Return a check that always gives a `Rejection` or None.

    Args:
        verifier: The function, or the name of an entry point of the group `coral.verifiers`.
        where: Flag or argument, for the error.

    Raises:
        InputError: There is no such entry point, or it is no function.
    """
    given: Any = verifier
    if isinstance(given, str):
        given = named_plugin("coral.verifiers", given, where)
    if not callable(given):
        raise InputError(where, "", repr(given), "a function of a question and an answer")
    check: Check = given

    def verify(question: Question[Any], answer: Any) -> Rejection | None:
        refusal = check(question, answer)
        return Rejection(code=CODE, reason=refusal) if isinstance(refusal, str) else refusal

    return verify

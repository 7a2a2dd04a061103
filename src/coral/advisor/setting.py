"""What an application gives to its advisors: rules, errors to make, an inbox, and how to call models."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.question import Advisor, Question, Rejection
from coral.errors import InputError
from coral.plugins import our_part

Answer = dict[str, Any]
"""An answer as JSON."""
Rule = Callable[[Mapping[str, Any], Sequence[Rejection]], BaseModel]
"""Answers one kind of question from its facts and the reasons for refusing earlier answers."""


@dataclass(frozen=True, kw_only=True)
class Earlier:
    """The right answer to an earlier question of the same kind."""

    at_s: float
    """Time of the question, on the clock of the world."""
    answer: Answer


Err = Callable[[Question[Any], Answer, Sequence[Earlier], np.random.Generator], Answer | str | None]
"""Makes the mistake: (question, right answer, earlier ones with the oldest first, random generator) to the wrong
answer, or a text that is none, or None if this mistake is impossible here."""


@dataclass(frozen=True, kw_only=True)
class Mistake:
    """One kind of error, in an application or in any."""

    name: str
    """Name on the command line."""
    what: str
    """Description of the error."""
    found_in: str
    """Published failure analysis in which models make it; "" if none is known."""
    questions: tuple[str, ...]
    """Kinds of question in which it can happen; () is any."""
    err: Err
    part: str = ""
    """The part of an answer that it spoils: a question that asks for several things at once has as many chances of
    error as questions that ask for one each."""


def known_mistakes(system: str) -> tuple[Mistake, ...]:
    """Return the plausible errors of a system, `reef` or `contact`; none where their wing is off, as `sloppy` is."""
    try:
        return tuple(our_part("mistakes", system, "--advisor"))
    except InputError:
        return ()


@dataclass(frozen=True, kw_only=True)
class Setting:
    """The context passed to the maker of an advisor."""

    rules: Mapping[str, Rule]
    """Rules of the application, kind of question to function of its facts."""
    rng: np.random.Generator
    """Random generator of advisors with errors."""
    inbox: Path | None
    """Folder for questions to a person."""
    model: ModelCfg
    """Configuration of real models."""
    where: str
    """Flag to name in an error message."""
    inner: Callable[[str], Advisor]
    """Makes the inner advisor of a wrapper from its string."""
    mistakes: tuple[Mistake, ...] = ()
    """The application's plausible errors, for `sloppy`."""

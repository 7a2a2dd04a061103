"""Context for making an advisor: rules, random numbers, an inbox, and how to call models."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.rules import Rule

if TYPE_CHECKING:
    from coral.advisor.question import Advisor
    from coral.advisor.sloppy import Mistake


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
    spoil: Mapping[str, Callable[..., dict[str, Any]]] = field(default_factory=dict)
    """The application's functions that spoil an answer for `fallible`, by kind of question."""
    mistakes: tuple[Mistake, ...] = ()
    """The application's plausible errors, for `sloppy`."""

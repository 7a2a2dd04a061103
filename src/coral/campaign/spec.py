"""One cell of a campaign's grid: system, variant, world, seed and advisor."""

from __future__ import annotations

import hashlib
import itertools
import json
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from coral.advisor.attribution import RECORDED_MODEL
from coral.advisor.registry import rules_alone
from coral.errors import InputError

NO_ADVISOR = "none"
"""Advisor of a variant without one; such an episode is compared with those of every advisor."""
MOST_EPISODES = 1_000_000


def called(advisor: str) -> str:
    """Return an advisor's name in tables and figures; rules are never presented as a model."""
    if advisor == NO_ADVISOR:
        return "none"
    if advisor == "heuristic":
        return "heuristic (embedded rules, no foundation model)"
    if advisor == "recorded":
        return RECORDED_MODEL
    if rules_alone(advisor):
        return f"{advisor} (embedded rules with simulated mistakes, no foundation model)"
    return advisor


@dataclass(frozen=True, kw_only=True)
class Spec:
    """Definition of an episode, apart from the campaign's configuration and the version of the code."""

    system: str
    variant: str
    world: str
    seed: int
    advisor: str
    overrides: tuple[tuple[str, Any], ...] = ()
    """Configuration keys (dotted) and JSON values that differ from the campaign's configuration, sorted."""

    def to_json(self) -> dict[str, Any]:
        """Return the plain mapping that is stored."""
        return {**vars(self), "overrides": dict(self.overrides)}

    @classmethod
    def from_json(cls, content: Mapping[str, Any]) -> Spec:
        """Restore the spec that `to_json` wrote."""
        return cls(**{**content, "overrides": tuple(sorted(content["overrides"].items()))})

    @property
    def digest(self) -> str:
        """Compute ten hexadecimal digits that depend on every field and on nothing else."""
        text = json.dumps(self.to_json(), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()[:10]

    @property
    def key(self) -> str:
        """Return the file name of the episode: readable at the start, unique by its digest."""
        parts = (self.world.rsplit("/", 1)[-1], self.variant, self.advisor, f"s{self.seed}")
        words = "_".join(re.sub(r"[^A-Za-z0-9.]+", "-", part).strip("-.")[:32] for part in parts)
        return f"{words}_{self.digest}"


def grid(
    system: str,
    *,
    variants: Sequence[str],
    worlds: Sequence[str],
    seeds: Sequence[int],
    advisors: Sequence[str],
    alone: Collection[str] = (),
    overrides: Sequence[Mapping[str, Any]] = ({},),
) -> tuple[Spec, ...]:
    """Return every combination once, worlds innermost so that an early look at the results sees all of them.

    Variants `alone` have no advisor; they run once, not once for each advisor. Each of the overrides, configuration
    keys and values, repeats the whole.

    Raises:
        InputError: A dimension is empty, or the grid is too large.
    """
    for flag, values in (("--variants", variants), ("--worlds", worlds), ("--seeds", seeds), ("--advisors", advisors)):
        if not values:
            raise InputError(flag, "", "nothing", "at least one")
    size = len(variants) * len(worlds) * len(seeds) * len(advisors) * len(overrides)
    if size > MOST_EPISODES:
        raise InputError("the grid", "", f"{size} episodes", f"at most {MOST_EPISODES}")
    specs = (
        Spec(
            system=system,
            variant=variant,
            world=world,
            seed=seed,
            advisor=NO_ADVISOR if variant in alone else advisor,
            overrides=tuple(sorted(change.items())),
        )
        for change, advisor, seed, variant, world in itertools.product(overrides, advisors, seeds, variants, worlds)
    )
    return tuple(dict.fromkeys(specs))


def parse_names(text: str, flag: str) -> tuple[str, ...]:
    """Parse names separated by commas, dropping duplicates.

    Raises:
        InputError: There is no name, or an empty one between two commas.
    """
    names = [name.strip() for name in text.split(",")]
    if not all(names):
        raise InputError(flag, "", repr(text), "names separated by commas")
    return tuple(dict.fromkeys(names))


def parse_seeds(text: str, flag: str = "--seeds") -> tuple[int, ...]:
    """Parse seeds such as `0-4` or `0,3,7-9`; ascending, without duplicates.

    Raises:
        InputError: The text is not a list of numbers and ranges.
    """
    seeds: set[int] = set()
    for part in text.split(","):
        match = re.fullmatch(r"\s*(\d{1,9})\s*(?:-\s*(\d{1,9})\s*)?", part, re.ASCII)
        if match is None:
            raise InputError(flag, "", repr(text), "numbers and ranges, such as 0-4 or 0,3,7-9")
        first, last = int(match[1]), int(match[2] or match[1])
        if last < first or last - first >= MOST_EPISODES:
            raise InputError(flag, "", repr(part.strip()), f"an ascending range of at most {MOST_EPISODES} seeds")
        seeds.update(range(first, last + 1))
    return tuple(sorted(seeds))

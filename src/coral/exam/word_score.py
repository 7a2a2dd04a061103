"""Score of an answer in a mission in words: where it goes next, what it rules out, what it takes things for."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from functools import cache
from typing import Any

from coral.exam.worth import Worth
from coral.reef.decide.mission_answer import MissionAnswer
from coral.reef.world.kinds import catalogue

NEXT, SKIP, MARKS = 0.5, 0.25, 0.25
"""Shares of the score."""
SAME: Mapping[str, str] = {"tire": "tyre", "trap": "pot", "oyster": "living"}
"""Words that people use for those in `kinds.yaml`."""


def score_mission(key: Mapping[str, Any], facts: Mapping[str, Any], answer: MissionAnswer) -> Worth:
    """Score an answer.

    Half for the next step: an oracle would go to the dot that it goes to or looks at. A quarter for the share of the
    dots that the instruction does not want and that are ruled out, less those that it wants. A quarter for the share of
    the dots with a picture that are named by their kind: all of the score where nothing else is asked.
    """
    marks = {str(mark.dot): mark.label for mark in answer.marks}
    named = sum(names_kind(marks.get(dot, ""), kind) for dot, kind in key["kinds"].items()) / len(key["kinds"])
    if "right" not in key:
        missed = [f"{dot}: {kind}" for dot, kind in key["kinds"].items() if not names_kind(marks.get(dot, ""), kind)]
        return Worth(named, f"{named:.0%} named{'; not ' * bool(missed)}{', '.join(missed)}")
    dot = answer.selected_centroid_index if answer.look is None else answer.look.dot
    right = dot in key["right"]
    skipped, unwanted = set(answer.skip), set(key["unwanted"])
    out = max(0, len(skipped & unwanted) - len(skipped & set(key["wanted"]))) / len(unwanted)
    wrong = f"dot {dot}, where {' or '.join(map(str, key['right']))} is right"
    why = f"{'a right next step' if right else wrong}; {out:.0%} of what may be left out is; {named:.0%} named"
    return Worth(NEXT * right + SKIP * out + MARKS * named, why)


def names_kind(label: str, kind: str) -> bool:
    """Check whether a label says more of this kind than of any other, by the words of `kinds.yaml`."""
    said = _words(label)
    worth = {name: sum(_rarity()[word] for word in said & words) for name, words in _vocabulary().items()}
    most = max(worth.values())
    return most > 0 and _family(kind) in {_family(name) for name, one in worth.items() if one == most}


def _family(kind: str) -> str:
    """Return what a kind is alike, whatever its age: both plots are plots."""
    return kind.partition("-")[0] if kind.startswith("plot") else kind


def _words(text: str) -> set[str]:
    found = {word.rstrip("s") for word in re.findall(r"[a-z]{3,}", text.lower())}
    return {SAME.get(word, word) for word in found}


@cache
def _vocabulary() -> dict[str, set[str]]:
    return {name: _words(f"{name} {kind.says}") for name, kind in catalogue().kinds.items()}


@cache
def _rarity() -> dict[str, float]:
    """Return how much a word tells: the fewer kinds it is said of, the more."""
    count = Counter(word for words in _vocabulary().values() for word in words)
    return {word: 1.0 / number for word, number in count.items()}

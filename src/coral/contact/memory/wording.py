"""Words of manipulation by meaning: verbs and things as concepts, instructions that contradict each other, embeddings.

Similar texts may mean different tasks ("flip against the wall", "flip away from the wall"): the similarity only ranks
experiences that match in goals and numbers.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from functools import cache

import numpy as np
from numpy.typing import NDArray

CONCEPTS: Mapping[str, str] = {
    "lift": "lift pick raise hoist heave elevate",
    "hold": "hold grasp grab grip seize clutch take keep",
    "carry": "carry transport fetch bring transfer deliver",
    "push": "push shove press nudge slide shift drag propel poke drive",
    "put": "put place set lay deposit position stand",
    "flip": "flip tip topple turn rotate overturn knock roll rear upend invert",
    "open": "open unlock unfold",
    "close": "close shut fold",
    "pull": "pull draw extract remove tug withdraw",
    "insert": "insert plug drop fit stick",
    "stack": "stack pile tower top upon atop above",
    "release": "release leave let",
    "move": "move",
    "still": "still steady motionless calm constant even smoothly evenly steadily",
    "gentle": "gentle gently soft softly careful carefully light lightly",
    "upright": "upright standing level straight tilting vertical end",
    "box": "box carton package parcel case crate block brick cube container",
    "cylinder": "can tin cylinder bottle jar mug cup",
    "peg": "peg pin dowel rod stick bolt",
    "hole": "hole well socket slot opening",
    "board": "board plate plank tray panel",
    "handle": "handle grip knob",
    "lid": "lid cover cap hinge",
    "drawer": "drawer compartment",
    "chest": "chest cabinet cupboard dresser",
    "wall": "wall barrier",
    "table": "table tabletop desk bench",
    "edge": "edge side rim border",
    "goal": "goal target mark marked spot destination",
    "mat": "mat pad",
    "red": "red crimson scarlet",
    "blue": "blue azure navy",
    "force": "force newton newtons pressure",
    "clutter": "clutter crowd others things items objects rest",
    "flat": "flat broad large face lying lie",
    "wood": "wooden chopping cutting wood",
}
"""Concepts, each with the words that mean it in an instruction for a robot's hand."""
OPPOSED = (
    (frozenset({"push"}), frozenset({"carry", "lift"})),
    (frozenset({"open", "pull"}), frozenset({"close"})),
    (frozenset({"insert"}), frozenset({"pull"})),
)
"""Actions that exclude each other, unless an instruction asks for both."""
Vector = NDArray[np.float32]
BINS = 512
_STOP = "a an and as at by for from in into is it its of on onto or out over that the then to up with"
STOP = frozenset(_STOP.split())


@cache
def _word_concepts() -> dict[str, str]:
    return {word: concept for concept, words in reversed(list(CONCEPTS.items())) for word in words.split()}


def concept_of(word: str) -> str:
    """Return the concept of a lower-case word in any inflection; the word itself if it has none."""
    known = _word_concepts()
    for form in _forms(word):
        if form in known:
            return known[form]
    return word


def _forms(word: str) -> list[str]:
    """Return a word and what it may be an inflection of."""
    forms = [word]
    for ending, others in (("s", ("",)), ("es", ("",)), ("ing", ("", "e")), ("ed", ("", "e")), ("er", ("",))):
        if word.endswith(ending) and len(word) > len(ending) + 2:
            stem = word.removesuffix(ending)
            forms += [stem + other for other in others]
            if len(stem) > 2 and stem[-1] == stem[-2]:
                forms.append(stem[:-1])
    return forms


def concepts_of(text: str) -> list[str]:
    """Return the concepts of a text in order; words without one stand for themselves."""
    return [concept_of(word) for word in re.findall(r"[a-z]+", text.lower())]


def contradict(first: str, second: str) -> bool:
    """Check whether two instructions ask for actions that exclude each other, as pushing and carrying do."""
    one, other = set(concepts_of(first)), set(concepts_of(second))
    return any(
        (_only(one, a, b) and _only(other, b, a)) or (_only(one, b, a) and _only(other, a, b)) for a, b in OPPOSED
    )


def _only(said: set[str], wanted: frozenset[str], excluded: frozenset[str]) -> bool:
    return bool(said & wanted) and not said & excluded


def embed(text: str) -> Vector:
    """Hash the concepts of a text into bins: a vector of length 1, Shape=(n,), the same on every machine."""
    found = np.zeros(BINS, dtype=np.float32)
    # How often a concept is repeated says little about the task.
    for concept in sorted(set(concepts_of(text)) - STOP):
        digest = hashlib.blake2b(concept.encode(), digest_size=8).digest()
        # With a sign of its own, so that words in one bin cancel rather than add.
        found[int.from_bytes(digest[:4], "big") % BINS] += 1.0 if digest[4] % 2 else -1.0
    length = float(np.linalg.norm(found))
    return found / np.float32(length) if length else found

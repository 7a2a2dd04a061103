"""Embeddings of task texts, offline and without torch: concepts by default, WordLlama's weights if installed.

Similar texts may mean different tasks ("flip against the wall", "flip away from the wall"): the similarity only ranks
experiences that match in goals and numbers.
"""

from __future__ import annotations

import hashlib
import itertools
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from coral.contact.memory.wording import concepts_of
from coral.errors import InputError, first_line
from coral.plugins import named_plugin

Vector = NDArray[np.float32]
STOP = frozenset(
    (
        "a",
        "an",
        "and",
        "as",
        "at",
        "by",
        "for",
        "from",
        "in",
        "into",
        "is",
        "it",
        "its",
        "of",
        "on",
        "onto",
        "or",
        "out",
        "over",
        "that",
        "the",
        "then",
        "to",
        "up",
        "with",
    )
)


class Embedder(Protocol):
    """Maps a text to a unit vector; vectors of different embedders are not comparable."""

    name: str

    def embed(self, text: str) -> Vector:
        """Return the embedding, Shape=(n,), length 1."""
        ...


class HashedWords:
    """Words and pairs of neighbouring words, hashed into bins with equal weight: no weights file, no download, weak.

    Args:
        size: Number of bins.
    """

    name = "hashed-words"

    def __init__(self, size: int = 512) -> None:
        self.size = size

    def embed(self, text: str) -> Vector:
        """See `Embedder.embed`."""
        words = [word for word in re.findall(r"[a-z]+", text.lower()) if word not in STOP]
        grams = [
            *words,
            *(f"{a} {b}" for a, b in itertools.pairwise(words)),
            *(word[:5] for word in words if len(word) > 5),
        ]
        found = np.zeros(self.size, dtype=np.float32)
        for gram in grams:
            _count(found, gram)
        return _unit(found)


class HashedConcepts:
    """The concepts of a text's words (`wording.py`), hashed into bins: a small lexicon, no weights file.

    Args:
        size: Number of bins.
    """

    name = "hashed-concepts"

    def __init__(self, size: int = 512) -> None:
        self.size = size

    def embed(self, text: str) -> Vector:
        """See `Embedder.embed`."""
        found = np.zeros(self.size, dtype=np.float32)
        # How often a concept is repeated says little about the task.
        for concept in sorted({concept for concept in concepts_of(text) if concept not in STOP}):
            _count(found, concept)
        return _unit(found)


class WordLlamaEmbedder:
    """WordLlama's embedding with 256 dimensions, from the weights in its package."""

    name = "wordllama-256"

    def __init__(self) -> None:
        import wordllama  # type: ignore[import-untyped,import-not-found,unused-ignore]

        # Without cache_dir its loader looks for the tokenizer in the wrong folder.
        self._model: Any = wordllama.WordLlama.load(cache_dir=Path(wordllama.__file__).parent, disable_download=True)

    def embed(self, text: str) -> Vector:
        """See `Embedder.embed`."""
        return _unit(np.asarray(self._model.embed([text])[0], dtype=np.float32))


EMBEDDERS: dict[str, Callable[[], Embedder]] = {
    "wordllama": WordLlamaEmbedder,
    "concepts": HashedConcepts,
    "words": HashedWords,
}
"""The embedders that come with the package, by the name that a configuration gives."""
DEFAULT = "concepts"
"""Without packages or weights, so that a trial does not depend on what is installed."""


def embedder_of(name: str) -> Embedder:
    """Return an embedder by name.

    Args:
        name: One of `EMBEDDERS`, or an entry point of the group `coral.embedders`.

    Raises:
        InputError: There is none of this name, or it cannot be loaded.
    """
    where = "--cfg.think.memory.embedder"
    if name not in EMBEDDERS:
        made: Embedder = named_plugin("coral.embedders", name, where, ours=tuple(EMBEDDERS))()
        return made
    try:
        return EMBEDDERS[name]()
    except Exception as error:  # an optional package may fail to load in any way
        raise InputError(
            where, "", f"{name}, which does not load ({first_line(error)})", "an embedder whose package is installed"
        ) from None


def _count(bins: Vector, gram: str) -> None:
    """Add a word to its bin, with a sign of its own so that words in one bin cancel rather than add."""
    digest = hashlib.blake2b(gram.encode(), digest_size=8).digest()
    bins[int.from_bytes(digest[:4], "big") % len(bins)] += 1.0 if digest[4] % 2 else -1.0


def _unit(vector: Vector) -> Vector:
    length = float(np.linalg.norm(vector))
    return vector / np.float32(length) if length else vector

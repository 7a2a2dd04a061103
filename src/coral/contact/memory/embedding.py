"""Embeddings of task texts, offline and without torch: WordLlama's weights if installed, else hashed word counts.

Similar texts may mean different tasks ("flip against the wall", "flip away from the wall"): the similarity only ranks
experiences that match in goals and numbers.
"""

from __future__ import annotations

import hashlib
import itertools
import re
from functools import cache
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

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
            digest = hashlib.blake2b(gram.encode(), digest_size=8).digest()
            found[int.from_bytes(digest[:4], "big") % self.size] += 1.0 if digest[4] % 2 else -1.0
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


@cache
def best_embedder() -> Embedder:
    """Return WordLlama if it is installed and loads, else hashed words; its name tells which."""
    try:
        return WordLlamaEmbedder()
    except Exception:  # an optional package may fail to load in any way
        return HashedWords()


def _unit(vector: Vector) -> Vector:
    length = float(np.linalg.norm(vector))
    return vector / np.float32(length) if length else vector

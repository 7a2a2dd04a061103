"""Embeddings of task texts, offline: the concepts of a small lexicon, or an embedder of another package.

Similar texts may mean different tasks ("flip against the wall", "flip away from the wall"): the similarity only ranks
experiences that match in goals and numbers.
"""

from __future__ import annotations

import hashlib
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coral.contact.memory.wording import concepts_of
from coral.plugins import named_plugin

Vector = NDArray[np.float32]
_STOP = "a an and as at by for from in into is it its of on onto or out over that the then to up with"
STOP = frozenset(_STOP.split())


class Embedder(Protocol):
    """Maps a text to a unit vector; vectors of different embedders are not comparable."""

    name: str

    def embed(self, text: str) -> Vector:
        """Return the embedding, Shape=(n,), length 1."""


class HashedConcepts:
    """The concepts of a text's words (`wording.py`), hashed into bins: a small lexicon, no weights file."""

    name = "hashed-concepts"

    def __init__(self, size: int = 512) -> None:
        self.size = size

    def embed(self, text: str) -> Vector:
        """See `Embedder.embed`."""
        found = np.zeros(self.size, dtype=np.float32)
        # How often a concept is repeated says little about the task.
        for concept in sorted(set(concepts_of(text)) - STOP):
            digest = hashlib.blake2b(concept.encode(), digest_size=8).digest()
            # With a sign of its own, so that words in one bin cancel rather than add.
            found[int.from_bytes(digest[:4], "big") % self.size] += 1.0 if digest[4] % 2 else -1.0
        length = float(np.linalg.norm(found))
        return found / np.float32(length) if length else found


DEFAULT = "concepts"


def embedder_of(name: str) -> Embedder:
    """Return an embedder by name: `concepts`, or an entry point of the group `coral.embedders`.

    Raises:
        InputError: There is none of this name, or it cannot be loaded.
    """
    if name == DEFAULT:
        return HashedConcepts()
    made: Embedder = named_plugin("coral.embedders", name, "--cfg.think.memory.embedder", ours=(DEFAULT,))()
    return made

"""An experience as every store keeps it."""

from __future__ import annotations

from dataclasses import dataclass, field

from coral.contact.memory.embedding import Vector

BUSY_S = 30.0
"""Longest wait for other writers."""


@dataclass(frozen=True)
class Row:
    """One stored experience."""

    id: int
    """Number of the experience, from 1."""
    created: str
    """Time of storage, UTC."""
    record: str
    """The experience as JSON."""
    embedder: str
    """Name of the embedder of the vector."""
    vector: Vector = field(compare=False, repr=False)
    """Embedding of the instruction, Shape=(n,); vectors of different embedders are not comparable."""
    used: int = 0
    helped: int = 0
    """Number of uses, and number of uses that ended in success."""

"""An experience as every store keeps it."""

from __future__ import annotations

from dataclasses import dataclass, field

from coral.contact.memory.embedding import Vector

BUSY_S = 30.0
"""Longest wait for others that write."""


@dataclass(frozen=True)
class Row:
    """One stored experience.

    Args:
        id: Its number, from 1.
        created: When it was stored, UTC.
        record: The experience as JSON.
        embedder: Who made the vector.
        vector: Of the instruction, Shape=(n,); vectors of different embedders cannot be compared.
        used, helped: How often it was used, and how often that ended in success.
    """

    id: int
    created: str
    record: str
    embedder: str
    vector: Vector = field(compare=False, repr=False)
    used: int = 0
    helped: int = 0

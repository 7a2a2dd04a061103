"""An experience as every store keeps it."""

from __future__ import annotations

from dataclasses import dataclass, field

from coral.contact.memory.embedding import Vector

BUSY_S = 30.0
"""Longest wait for others that write."""


@dataclass(frozen=True)
class Row:
    """One stored experience."""

    id: int
    """Its number, from 1."""
    created: str
    """When it was stored, UTC."""
    record: str
    """The experience as JSON."""
    embedder: str
    """Who made the vector."""
    vector: Vector = field(compare=False, repr=False)
    """Of the instruction, Shape=(n,); vectors of different embedders cannot be compared."""
    used: int = 0
    helped: int = 0
    """How often it was used, and how often that ended in success."""

"""Scenes of LIBERO-OBJECT as contact tasks, read from an installed package; see `docs/reference/libero.md`.

A wing. It needs no other.
"""

"""Scenes of LIBERO-OBJECT as contact tasks, read from an installed package; see `docs/reference/libero.md`."""

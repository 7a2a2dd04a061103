"""States and oracles for cost programs."""

from cost_oracles import board, exactly, plainly, schema, states  # noqa: F401

"""States for cost programs."""

from cost_oracles import board, schema, states  # noqa: F401

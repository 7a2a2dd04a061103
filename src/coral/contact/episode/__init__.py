"""One trial from its start to its end: the loop, its record, metrics, and the variants that are compared."""

"""One trial from start to end: the loop, its record, its metrics, and the variants that are compared."""

"""Many episodes: grids, executors, crash-safe results, tables."""

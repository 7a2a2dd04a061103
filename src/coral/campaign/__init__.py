"""Campaigns of many episodes: grids, executors, crash-safe results, tables."""

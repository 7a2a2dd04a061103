"""Colour pictures of a simulated reef, and the networks that are trained on them.

A wing. It needs `coral.reef.generator` for reefs to train on, and its commands `coral.reef.recordings` for tables of
poses.
"""

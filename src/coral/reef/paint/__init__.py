"""Colour pictures of a simulated reef, and the networks that are trained on them.

A wing. It needs `coral.reef.generator` for reefs to train on, and its commands `coral.view` for sheets of pictures and
`coral.reef.recordings` for their tables of poses.
"""

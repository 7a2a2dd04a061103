"""Colour pictures of a simulated reef, and the networks that are trained on them.

A wing. Its commands need `coral.view` for sheets of pictures, and `coral.reef.recordings` for their tables of poses.
"""

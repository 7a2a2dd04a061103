"""Hypothesis for all tests: the same examples in every run, and no limit on wall time."""

from hypothesis import settings

settings.register_profile("coral", deadline=None, derandomize=True)
settings.load_profile("coral")

"""A policy server that does what a test tells it to."""

from policy_server import hasty, patient, serve  # noqa: F401

"""Answers about how to act: cost plans, contact regions (Eq. 3), and the checks of both."""

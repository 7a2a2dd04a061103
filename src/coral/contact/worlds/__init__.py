"""Evaluation worlds: where a trial runs."""

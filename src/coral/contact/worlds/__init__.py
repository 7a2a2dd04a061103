"""Evaluation worlds: where a trial really takes place."""

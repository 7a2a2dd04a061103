"""Asking a foundation model without trusting it."""

"""Colour pictures of a simulated reef, and the networks that are trained on them."""

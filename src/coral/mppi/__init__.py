"""Sampling-based optimal control, shared by both applications."""

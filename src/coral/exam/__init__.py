"""Benchmark of an advisor: frozen questions with scored answers, without a mission or an episode around them."""

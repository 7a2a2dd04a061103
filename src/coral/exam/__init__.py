"""Benchmark of an advisor: frozen questions with scored answers, without a mission or an episode around them.

A wing. It needs `coral.view` for its page.
"""

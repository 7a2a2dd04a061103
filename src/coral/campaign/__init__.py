"""Campaigns of many episodes: grids, executors, crash-safe results, tables.

A wing. It needs `coral.view` for its pages, and `coral.contact.policy` where a policy is compared.
"""

"""Campaigns of many episodes: grids, executors, crash-safe results, tables.

A wing. It needs `coral.view` for its pages, `coral.reef.generator` for the halves of missions in words, and
`coral.contact.policy` where a policy is compared.
"""

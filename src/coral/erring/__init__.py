"""Advisors that err as models do, to examine what checks them; the errors of a system are beside its rooms.

A wing. It needs no other.
"""

"""Reefs that are made: from a topology, at random by number, with missions in words; pools; one thing on bare sand.

A wing. It needs no other.
"""

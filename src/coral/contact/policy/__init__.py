"""Vision-language-action policies that run on a server, on the same tasks and in the same worlds.

A wing. It needs no other.
"""

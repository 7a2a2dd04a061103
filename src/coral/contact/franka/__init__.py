"""A Franka arm as a robot's world: its stream, limits, preflight, and a simulated double that speaks its protocol.

A wing. It needs `coral.contact.real_scenes` where a camera tracks the objects.
"""

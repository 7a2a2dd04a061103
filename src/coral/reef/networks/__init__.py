"""Networks of one's own as eyes, in the layouts that people have: YOLO, semantic networks, relative depth.

A wing. It needs no other.
"""

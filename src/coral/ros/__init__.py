"""ROS 2 without a system of ours: nodes, bags, and the pictures in messages.

A wing. It needs no other.
"""

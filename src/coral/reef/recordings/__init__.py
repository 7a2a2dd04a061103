"""Recordings of a survey, ours or not, as one sequence of keyframes: run folders, pictures with poses, ROS bags.

A wing. It needs `coral.ros` for bags, and `coral.reef.sea` for cameras and what ArduSub says.
"""

"""A survey over ROS 2: vehicle and camera by topics, what is found and decided as topics, the operator by services.

A wing. It needs `coral.ros`, `coral.reef.sea` and the pictures of `coral.reef.recordings`.
"""

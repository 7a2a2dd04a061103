"""Cameras that deliver colour and depth: recordings, ROS 2 bags, RealSense, and those of other packages."""

"""Recordings of a survey, ours or not, as one sequence of keyframes: run folders, pictures with poses, ROS bags."""

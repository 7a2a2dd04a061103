"""What the robot knows: occupancy map, centroid chain, cost field, landmarks, and where it is."""

"""The imaging sonar: range images, a simulated Sonar 3D-15, and the obstacles that it puts on the map."""

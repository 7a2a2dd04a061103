"""What the robot is: hull, dynamics, cameras and sonar, what it measures, and the states that it can be in."""

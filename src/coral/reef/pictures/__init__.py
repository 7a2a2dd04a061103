"""What the advisor sees: the robot's map, its camera's classes and depth, drawn as the pictures of a question."""

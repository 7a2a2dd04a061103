"""The robot's eyes: colour pictures of the simulated reef, and what is seen in pictures."""

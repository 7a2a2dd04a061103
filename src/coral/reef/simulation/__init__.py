"""The world's side of a simulated mission: motion, pictures, noise, navigation sensors, what was covered."""

"""Where the objects are: a ray-cast RGB-D camera, and pose registration and tracking from its pictures."""

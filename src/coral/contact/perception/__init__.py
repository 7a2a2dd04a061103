"""Object poses from pictures: a ray-cast RGB-D camera, pose registration and tracking."""

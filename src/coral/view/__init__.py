"""What people look at: map pictures, video, the run report, the live view."""

"""Map pictures, video, run reports and the live view."""

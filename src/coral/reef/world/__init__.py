"""A reef as a file: oysters, obstacles, the survey's edge; its check and its geometry."""

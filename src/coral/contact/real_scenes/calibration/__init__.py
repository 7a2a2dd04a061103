"""Where a camera stands: from a board, or from points that the hand touches."""

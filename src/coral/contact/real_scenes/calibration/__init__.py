"""Where a camera stands: from a board at a known place, or in the hand."""

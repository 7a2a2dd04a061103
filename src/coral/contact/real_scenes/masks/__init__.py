"""Masks of objects in pictures, without ground truth: by colour, or by a network of another package."""

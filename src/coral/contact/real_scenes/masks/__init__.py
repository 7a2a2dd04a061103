"""Masks of objects in pictures, without ground truth: by colour, from a click, by a network."""

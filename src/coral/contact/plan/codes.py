"""Why an answer about a task is refused, besides the errors of a cost."""

from __future__ import annotations

CODES = {
    "objects": "An object is missing, unknown, or named twice.",
    "bounds": "A mass or friction is outside its bounds.",
    "density": "No material has this mass in this size.",
    "replay": "Replayed with these values, the history is explained no better.",
    "stages": "Stages where one function is asked for.",
    "imagined-run": "A remembered plan fails in its imagined run.",
    "none": "There is no region.",
    "too-many": "There are too many regions on an object.",
    "not-finite": "A region holds a value that is not a finite number.",
    "normal": "The normal of a region has not length 1.",
    "extent": "A region is too small or too large.",
    "stage": "The plan has no stage of this name.",
    "opening": "The fingers do not open so far.",
    "off-surface": "A region is off the object's surface.",
    "inward": "The normal points into the object.",
    "underside": "The normal points down at the table.",
    "too-wide": "The object is too wide there for the fingers.",
    "below-table": "A region lies below the table's top.",
    "missed": "No point of a region meets the object.",
    "out-of-reach": "The hand reaches no point of a region.",
    "buried": "Something is in the way of every point of a region.",
    "pose": "A pose holds something that is no number.",
    "place": "An object would be off the table.",
}
"""Meaning of each code."""

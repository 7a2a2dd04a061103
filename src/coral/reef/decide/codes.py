"""Why a verifier of a survey refuses an answer."""

from __future__ import annotations

CODES = {
    "blocked": "The point lies in an obstacle, or obstacles cut it off.",
    "outside": "The point lies outside the survey area.",
    "no-such-centroid": "There is no such dot on the map.",
    "visited": "The dot is done.",
    "finished": "Within 3 m of the point everything is known and done, and nothing that is left is nearer from there.",
    "too-dear": "To look where something is expected costs more than is allowed.",
    "too-close": "The point is where the robot will be, or at the last goal.",
    "contradiction": "The answer contradicts itself.",
    "not-done": "The survey cannot end, or be left to the robot, while dots are left.",
    "behind-robot": "`paper`: the point is behind the robot.",
    "behind-previous": "`paper`: the point leads back from the previous goal.",
    "deviation": "`paper`: the point deviates from the trend of the chain.",
    "own": "A verifier of your own refuses it.",
}
"""Meaning of each code."""

"""End reasons of surveys."""

from __future__ import annotations

END_REASONS = {
    "nothing left to explore": "the robot finds no cluster and no open water that it could still reach, and no "
    "doubtful obstacle hides any",
    "the advisor ended the survey": "an answer said so, or declared a mission in words done",
    "coverage complete": "with `--cfg.stop-when-covered`: every true cluster has been covered, which only the "
    "experimenter knows",
    "the tour is done": "a blind sweep or the oracle reached the end of its path",
    "time limit": "`--cfg.time-limit-s`, 600 by default",
    "advisor failed": "the advisor did not decide, with `--fallback fail`",
    "surfaced": "a sensor was silent for too long, or a limit sent the vehicle up; the simulated vehicle of `coral "
    "reef run` keeps its depth, so this ends its survey",
    "left to surface": "at sea, the same, and the ascent was not seen to end",
    "back at the start": "at sea, a limit or the operator sent the vehicle back",
    "disarmed by the operator": "at sea, the operator's word",
    "stopped by the operator": "Ctrl-C, the stop button, or at sea the operator's word; of another signal its name: "
    "`stopped by SIGTERM`",
    "failed": "an error in the program, which the command line shows",
}
"""Explanation of each end reason of a survey. A reason may be followed by a colon and why, or in brackets by whom."""

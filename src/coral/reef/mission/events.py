"""What `events.jsonl` of a survey holds: each event with its keys, which stand in backticks, and why surveys end."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

EVENTS = {
    "start": "`world`, `advisor`, `variant`, `preset`, `seed`, `clusters_total`; `own_parts`: parts exchanged in "
    "Python. At sea also `judged_by`, `vehicle`, `camera`, `sonar` and `resumed`.",
    "instruction": "The words of a mission, at the start or changed under way: `text`, and `by` whom.",
    "question": "A question was asked: number of the `decision`, `attempt` (0: the first), `mode`, digests of its "
    "`pictures`, `centroids` of the chain.",
    "verdict": "An answer was judged: `decision`, `attempt`, `verdict`, `code` of a refusal, `tokens_in`, "
    "`tokens_out`, `cost_usd`, `faults` of a bad reply; `reason` of a refusal, the `answer`, and when it was "
    "`asked_at` (s).",
    "goal": "A goal was adopted: `x`, `y` (m); its `source` (an advisor or fallback, `initial`, `tour`, `home`), "
    "`decision`, `reason`; `index` of the cluster; `centroids`; `violates`: whether it goes back or off the trend "
    "(Eqs. 4-8); `waits`: goals before it; `then`: goals after it; `later_s`: what it costs; `expect`: what the "
    "advisor expects there; in a mission in words also the side it is to `look` from, and what was `said` of things.",
    "held": "A decision without a goal: `source`, `decision`, `reason`; in a mission in words also its `answer`, "
    "`said`, `look`, `violates`.",
    "fallback": "The advisor did not decide: `decision`, `failure`, and the `policy` that took over.",
    "guess": "What an advisor expected at `x`, `y` was checked: `what`, how `sure`, whether it was a `hit`.",
    "mode": "The `mode` of questions changed: centroids or free waypoints.",
    "trigger": "The smart trigger's verdict changed (Eq. 12): `cause`, `fired`, `held_by`.",
    "monitor": "The reference path was planned anew: `deviation_m`.",
    "planner_failure": "No rollout was feasible, and the vehicle brakes: `reason`.",
    "doubt": "The robot looks again at doubtful places before it ends: `look`.",
    "cluster_covered": "A true cluster was covered: `name`, `fraction` of its area.",
    "collision": "Contact with `obstacle` at `x`, `y` (m).",
    "state": "The vehicle's state changed: the new `state`, the old one (`was`), `cause`, `by` whom, `reason`.",
    "sensor": "An `input` of the pilot was `refused`, and why (empty: it is accepted again); `detail`.",
    "blind": "The sonar alone shows the way (`blind`), or no longer: `reason`.",
    "deaf": "The sonar is silent (`deaf`), or no longer: `reason`.",
    "sight": "How far the eyes tell oysters from sea floor, `reach_m`, by a network's doubt; nothing farther away "
    "counts as explored.",
    "awaited": "At sea, what ends a state: `state`, `reason`, `ends_when`.",
    "operator": "At sea, the operator said a `word`, from a `source` (keyboard, page, ROS).",
    "unwind": "At sea, the vehicle turns on the spot against `turns` of its tether.",
    "limit": "At sea, a limit was reached: `cause`, `reason`, and the `action` taken.",
    "vehicle_text": "At sea, a message of the autopilot: `severity`, `text`.",
    "late_tick": "At sea, a tick ended late: by `behind_ms`, of which it began `woken_ms` late and computed for "
    "`control_ms`.",
    "place": "At sea, whether a resumed survey has found itself on the saved map: its `landmarks`, those that were "
    "`recognised`, and what the odometry is off by: `x`, `y` (m), `theta` (rad).",
    "recording_stopped": "At sea, nothing more is recorded, for instance because the disk is full: `reason`.",
    "order": "At sea, the vehicle was given an `order`.",
    "order_refused": "At sea, the vehicle refused an `order`: `reason`.",
    "left": "At the end, `clusters` that were not finished, each with why; `centroids` of the chain.",
    "judged": "At the end, the truth: `clusters` with the share imaged and inspected, the robot's `tracks` and "
    "`phantoms` among them, time of a tour that knows the reef (`oracle_time_to_90_s`); in a mission in words "
    "`instruction` with its conditions.",
    "end": "The last line: `reason`.",
}
"""Every line also has `step` and `t` (simulated seconds)."""

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


def sight_told(event: Mapping[str, Any]) -> str:
    """Return what the event `sight` says, in words."""
    return f"the eyes tell oysters from sea floor up to {event['reach_m']:.1f} m away"


def place_told(event: Mapping[str, Any]) -> str:
    """Return what the event `place` says, in words."""
    if not event["recognised"]:
        return f"none of {event['landmarks']} landmarks recognised - is this the place? The pose is not corrected by it"
    off = f"{math.hypot(event['x'], event['y']):.2f} m and {abs(math.degrees(event['theta'])):.0f} degrees"
    return f"{event['recognised']} of {event['landmarks']} landmarks recognised, odometry off by {off}"

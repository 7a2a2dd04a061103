"""Metrics of a contact episode, computed from its run folder alone."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping
from itertools import pairwise
from pathlib import Path
from statistics import fmean, median
from typing import Any

from coral.advisor.attribution import DEFINITIONS as ATTRIBUTION
from coral.advisor.attribution import attribution_of
from coral.errors import InputError
from coral.run_files import RunFiles
from coral.runs import read_events, read_rows

HAND = {"hand", "left", "right"}

DEFINITIONS = {
    "success": "Whether all of the task's conditions held, without a break, for its `hold_s` (paper, section 4).",
    "end_reason": "Reason of the episode's end: success, timeout, or the name of a failure.",
    "end_detail": "More about the end: which conditions did not hold, and by how much, or what failed.",
    "sim_time_s": "Simulated time (s) at the end, without the advisor's latencies; of a success the "
    "paper's completion time.",
    "time_with_thinking_s": "The same with all latencies, those before the first plan included.",
    "steps": "Control steps.",
    "plans": "Number of plans (MPPI updates).",
    "policy_calls": "Number of action chunks requested from a served policy.",
    "stages": "Number of changes from one stage of the strategy to another.",
    "strategy": "Name of the last strategy.",
    "advisor_calls": "Number of requests to the advisor, repetitions after a refusal included.",
    **ATTRIBUTION,
    "repairs": "Number of changes of strategy or beliefs during the episode.",
    "interventions": "Number of times that a person changed the weight of a cost's term on the live page: with any, "
    "the result is not the strategy's alone.",
    "memory_hit": "Whether the episode began with a remembered plan.",
    "path_length_m": "Length of the tool's path (m).",
    "peak_hand_force_n": "Largest net force (N) of the hand on an object.",
    "mean_hand_force_n": "Mean of that force (N) while the hand touched an object.",
    "contact_time_s": "Time (s) during which the hand touched an object.",
    "contacts": "Number of contacts that began during the episode, except those between fixed things.",
    "first_touch_s": "Simulated time (s) at which the hand first touched an object.",
    "plan_cost": "Mean expected cost of the plans.",
    "plan_cost_jump": "Mean change of that cost from one plan to the next within a stage: how erratic planning was.",
    "plan_late_ms_median": "Median time (ms) between a plan's state and its use, with `planning.latency`; 0 without.",
    "effective_samples": "Mean effective sample size of the plans.",
    "diverged_rollouts": "Number of rollouts in the planning world excluded because they diverged.",
    "track_lost": "Number of times that the tracker lost an object.",
    "track_recovered": "Number of times that it found one again.",
    "track_lost_s": "Time (s) during which an object was lost.",
    "pose_error_mm": "Median distance (mm) of tracked poses from the truth, modulo symmetry. No decision uses it.",
    "pose_error_deg": "Median angle (degrees) of the same errors.",
    "judged_by": "Who decided about success: the simulator's true state (truth), the measured poses (perception), or a "
    "person (operator). Without truth nothing is known of contacts and their forces.",
    "poses": "Source of the objects' poses: the simulator (ground-truth), a camera (tracked), an estimate from one "
    "picture (guessed), the robot itself (measured), or none (pictures).",
    "tracker": 'Tracker: model, the embedded one, or foundationpose, a server\'s; "" without tracking.',
}


def compute_metrics(folder: Path) -> dict[str, Any]:
    """Compute the metrics of a finished or killed run from events.jsonl and trajectory.csv.

    Raises:
        InputError: The folder is not a run.
    """
    for name in (RunFiles.EVENTS, RunFiles.TRAJECTORY):
        if not (folder / name).is_file():
            raise InputError(str(folder), name, "no such file", "a run folder")
    return metrics_of(read_events(folder / RunFiles.EVENTS), read_rows(folder / RunFiles.TRAJECTORY))


def metrics_of(events: Iterable[Mapping[str, Any]], rows: Iterable[Mapping[str, str]]) -> dict[str, Any]:
    """Compute metrics from the events and the rows of the trajectory, both in order."""
    events = list(events)
    of: defaultdict[str, list[Mapping[str, Any]]] = defaultdict(list)
    for event in events:
        of[event["event"]].append(event)
    start, end = ((of[kind] or [{}])[-1] for kind in ("start", "end"))
    plans, tracks = of["plan"], of["track"]
    before = sum(float(event["seconds"]) for event in of["thinking"] if event["meanwhile"] == "before")
    within = sum(float(event["seconds"]) for event in of["thinking"] if event["meanwhile"] != "before")
    rated = [(str(plan.get("stage", "")), float(plan["cost"])) for plan in plans if plan.get("cost") is not None]
    costs = [cost for _, cost in rated]
    jumps = [abs(b - a) for (one, a), (other, b) in pairwise(rated) if one == other]
    ahead = [1e3 * float(plan.get("ahead_s", 0.0)) for plan in plans]
    effective = [float(plan["ess"]) for plan in plans]
    objects = set(start.get("trial", ()))
    pairs = [(event, {str(event.get("first")), str(event.get("second"))}) for event in of["contact"]]
    touches = [event for event, pair in pairs if len(pair & HAND) == 1 and pair & objects]
    path, last, step, t, earlier = 0.0, None, 0, 0.0, 0.0
    peak = impulse = touching = missed = 0.0
    felt = True
    off_m: list[float] = []
    off_rad: list[float] = []
    for row in rows:
        here = (float(row["x"]), float(row["y"]), float(row["z"]))
        path += math.dist(last, here) if last else 0.0
        last, step, earlier, t = here, int(float(row["step"])), t, float(row["t"])
        forces = [row[name] for name in row if name.endswith("_hand_force")]
        felt = felt and "" not in forces
        force = max(map(float, filter(None, forces)), default=0.0)
        peak = max(peak, force)
        off_m += _tracking_errors(row, "_off_m")
        off_rad += _tracking_errors(row, "_off_rad")
        missed += t - earlier if any(_tracking_errors(row, "_lost")) else 0.0
        if force > 0:
            impulse, touching = impulse + force * (t - earlier), touching + t - earlier
    return {
        "success": end.get("reason") == "success",
        "end_reason": str(end.get("reason", "killed")),
        "end_detail": str(end.get("detail", "")),
        "sim_time_s": round(t - within, 3),
        "time_with_thinking_s": round(t + before, 3),
        "steps": step,
        "plans": len(plans),
        "policy_calls": len(of["policy"]),
        "stages": sum(event.get("before") is not None for event in of["stage"]),
        "strategy": str(of["strategy"][-1]["name"]) if of["strategy"] else "",
        "advisor_calls": int(end.get("advisor_calls", 0)),
        **attribution_of(events),
        "repairs": int(end.get("repairs", 0)),
        "interventions": len(of["weight"]),
        "memory_hit": bool(end.get("memory_hit", False)),
        "path_length_m": round(path, 4),
        "peak_hand_force_n": round(peak, 2) if felt else None,
        "mean_hand_force_n": round(impulse / touching, 2) if touching else None,
        "contact_time_s": round(touching, 3) if felt else None,
        "contacts": sum(event["step"] > 0 for event in of["contact"]) if felt else None,
        "first_touch_s": float(touches[0]["t"]) if touches else None,
        "plan_cost": round(fmean(costs), 4) if costs else None,
        "plan_cost_jump": round(fmean(jumps), 4) if jumps else None,
        "plan_late_ms_median": round(median(ahead), 1) if ahead else None,
        "effective_samples": round(fmean(effective), 2) if plans else None,
        "diverged_rollouts": sum(int(plan["diverged"]) for plan in plans),
        "track_lost": sum(bool(event["lost"]) for event in tracks),
        "track_recovered": sum(not event["lost"] for event in tracks),
        "track_lost_s": round(missed, 3),
        "pose_error_mm": round(1e3 * median(off_m), 2) if off_m else None,
        "pose_error_deg": round(math.degrees(median(off_rad)), 2) if off_rad else None,
        "judged_by": str(start.get("judged_by", "truth")),
        "poses": str(start.get("poses", "")),
        "tracker": str(start.get("tracker", "")),
    }


def _tracking_errors(row: Mapping[str, str], ending: str) -> list[float]:
    """Return the tracking errors in a row of the trajectory; empty if nothing was tracked."""
    return [float(row[name]) for name in row if name.endswith(ending) and row[name] not in ("", "nan")]

"""The paper's metrics (IV-E), computed from a run folder alone, so anyone can recompute them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from coral.advisor.attribution import DEFINITIONS as ATTRIBUTION
from coral.advisor.attribution import attribution_of
from coral.errors import InputError
from coral.reef.mission import outcome
from coral.run_files import RunFiles
from coral.runs import read_events, read_rows

OWN_MAP, TRUTH = "the vehicle's own map", "the truth of a simulated reef"
"""Who judges a survey of `reef sail`."""

DEFINITIONS = {
    "coverage": "Share of the true oyster clusters of which at least 60 % of the area was inside the 120° field of "
    "view, within sensing range and not hidden by an obstacle, at some moment of the mission (paper IV-E).",
    "clusters_covered": "The number of those clusters.",
    "clusters_total": "The number of true clusters in the world.",
    "collisions": "Contacts of the 0.3 m robot disc with a true obstacle, checked at every integration step, counted "
    "once per contact (paper IV-E); null where nobody knows the truth.",
    "advisor_calls": "Questions put to the advisor, re-queries after a rejection included (paper: VLM invocations).",
    "requeries": "Those of the calls that repeated a question after a rejected, malformed or missing answer.",
    "rejections": "Answers refused by a verifier.",
    "fallbacks": "Decisions that were not reached within their budget, so that the fallback policy chose.",
    **ATTRIBUTION,
    "deviations": "Adopted waypoints that violate the backward or off-trend predicates (Eqs. 4-8) without an "
    "exemption (paper IV-E).",
    "steps": "Control ticks of 0.1 s.",
    "sim_time_s": "Simulated mission time (s): steps x 0.1 s. The control loop runs at every tick, so the paper's "
    "T_idle is 0.",
    "coverage_time_s": "Simulated time (s) at which the last cluster of this run was covered.",
    "steps_per_percent": "Steps for each percentage point of coverage (paper: coverage efficiency); null without any.",
    "distance_m": "Length of the true trajectory (m).",
    "min_clearance_m": "Smallest distance between the robot disc and a true obstacle (m), or, where nobody knows the "
    "truth, one on the vehicle's own map: below 0, that map had an obstacle where the vehicle was.",
    "planner_failures": "Control ticks at which no rollout was feasible and the vehicle braked.",
    "end_reason": "Why the mission ended.",
    "judged_by": "Who judged coverage, contacts and clearance of `reef sail`: the truth of a simulated reef, or, where "
    "nobody knows the truth, the vehicle's own map and sensors.",
    "late_ticks": "Control ticks of `reef sail` whose work ended over 0.1 s after their time, or that were left out.",
    "skipped_ticks": "Those of the late ticks that were left out.",
    "ticks": "Control ticks of `reef sail` that were run.",
    "worst_tick_ms": "Longest time from a tick's due time to the end of its work (ms).",
    "tick_ms_p999": "99.9th percentile of that time (ms).",
    "recording_failure": "Why the recording stopped during the survey; empty if it did not.",
    "recording_dropped": "Records that were dropped because too many waited.",
    "tether_turns": "Turns of the tether at the end, positive to the left.",
    "position_sigma_m": "Standard deviation of the position at the end, as the localizer reckons it (m).",
    "seconds_in_state": "Time (s) in each state of the vehicle.",
    "clusters_left": "Clusters that the robot knew of at the end and had not finished; the event `left` says why.",
    "preset": "Name of the water and sensors (`--preset`); null where it was not recorded.",
    "success": "Whether the conditions of a mission in words were all met in truth, without a contact; null "
    "for words without known conditions, which nobody judges.",
    "answer": "What the advisor answered when it said that such a mission was done; null if it did not.",
    "conditions": "Its conditions, each with what was found.",
    **outcome.DEFINITIONS,
}


def compute_metrics(folder: Path) -> dict[str, Any]:
    """Compute the metrics of a finished or killed run from events.jsonl and trajectory.csv.

    Raises:
        InputError: The folder is not a run.
    """
    for name in (RunFiles.EVENTS, RunFiles.TRAJECTORY):
        if not (folder / name).is_file():
            raise InputError(str(folder), name, "no such file", "a run folder")
    events = list(read_events(folder / RunFiles.EVENTS))
    rows = list(read_rows(folder / RunFiles.TRAJECTORY))
    return {**metrics_of(events, rows), **verdict_of(events), **outcome.outcome_metrics(folder, events, rows)}


def verdict_of(events: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the judge's verdict on a mission in words; empty for other missions."""
    told = next((e["instruction"] for e in reversed(events) if e["event"] == "judged" and "instruction" in e), None)
    return {} if told is None else {"success": told["met"], "answer": told["answer"], "conditions": told["conditions"]}


def covered_at(folder: Path) -> list[float]:
    """Return the simulated times (s) at which clusters were covered, ascending (coverage time, IV-E)."""
    return sorted(
        float(event["t"]) for event in read_events(folder / RunFiles.EVENTS) if event["event"] == "cluster_covered"
    )


def metrics_of(events: Iterable[Mapping[str, Any]], rows: Iterable[Mapping[str, str]]) -> dict[str, Any]:
    """Compute the metrics from the events and the rows of the trajectory, both in order."""
    events = list(events)
    told: dict[str, list[Mapping[str, Any]]] = {}
    for event in events:
        told.setdefault(event["event"], []).append(event)

    def of(kind: str) -> list[Mapping[str, Any]]:
        return told.get(kind, [])

    start: Mapping[str, Any] = of("start")[-1] if of("start") else {}
    judged_by = start.get("judged_by", TRUTH)
    clusters_total = int(start.get("clusters_total", 0))
    for event in of("judged"):
        if not clusters_total and "clusters" not in event:  # in real water: those on the vehicle's own map
            clusters_total = int(event["tracks"])
    steps, distance, clearance, covered, coverage, t, last = 0, 0.0, math.inf, 0, 0.0, 0.0, None
    for row in rows:
        here = (float(row["x"]), float(row["y"]))
        distance += math.dist(last, here) if last else 0.0
        last, steps, t = here, int(float(row["step"])), float(row["t"])
        clearance = min(clearance, float(row["clearance"]))
        covered, coverage = int(float(row["clusters_covered"])), float(row["coverage"])
    return {
        "coverage": coverage,
        "clusters_covered": covered,
        "clusters_total": clusters_total,
        "collisions": None if judged_by == OWN_MAP else len(of("collision")),
        "advisor_calls": len(of("question")),
        "requeries": sum(event["attempt"] > 0 for event in of("question")),
        "rejections": sum(event["verdict"] == "rejected" for event in of("verdict")),
        "fallbacks": len(of("fallback")),
        **attribution_of(events),
        "deviations": sum(bool(event.get("violates")) for event in of("goal")),
        "steps": steps,
        "sim_time_s": round(t, 3),
        "coverage_time_s": round(max((float(event["t"]) for event in of("cluster_covered")), default=0.0), 3),
        "steps_per_percent": round(steps / (100.0 * coverage), 3) if coverage else None,
        "distance_m": round(distance, 3),
        "min_clearance_m": round(clearance, 4) if math.isfinite(clearance) else None,
        "planner_failures": len(of("planner_failure")),
        "end_reason": of("end")[-1]["reason"] if of("end") else "killed",
        "preset": start.get("preset"),
        "seconds_in_state": seconds_in_states(events, t),
        "clusters_left": clusters_left(events),
    }


def seconds_in_states(events: Sequence[Mapping[str, Any]], end_s: float) -> dict[str, float]:
    """Return the time (s) in each state, by all events in order; empty if no states were recorded."""
    changes = [event for event in events if event["event"] == "state"]
    if not changes:
        return {}
    total: dict[str, float] = {}
    state, since = "ready", 0.0
    for change in changes:
        total[state] = total.get(state, 0.0) + float(change["t"]) - since
        state, since = str(change["state"]), float(change["t"])
    total[state] = total.get(state, 0.0) + max(end_s - since, 0.0)
    return {state: round(seconds, 3) for state, seconds in total.items() if round(seconds, 3) > 0.0}


def clusters_left(events: Sequence[Mapping[str, Any]]) -> int | None:
    """Return the number of known clusters that were not finished; None where it was not recorded."""
    told = [event for event in events if event["event"] == "left"]
    return len(told[-1]["clusters"]) if told else None

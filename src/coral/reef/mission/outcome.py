"""Metrics of imaging, path and position estimate, computed from a run folder alone."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.foreign_file import read_log_lines
from coral.run_files import SurveyFiles

Row = Mapping[str, str]
SHARES = (0.5, 0.8, 0.9, 1.0)
BUDGETS_S = (45, 60, 90)
HORIZON_S = 600.0
"""Time over which the area under a curve is averaged, the last value held: comparable for missions of any length."""
IDLE_M_S = 0.05
"""Speed over ground below which the vehicle stands still, turning or not: a twelfth of its cruise speed."""
OFF_ROUTE_M = 3.0
"""Distance beyond which the path has left the reef: d_lat, the largest offset of the reference in Eq. 7."""
BACK_ON_M = 2.5
"""Distance below which the path is back at the reef, so that driving along the limit counts once."""
SAMPLE_M, EARLIER_M, BESIDE_M, BACK_DEG, STRETCH_M = 0.5, 5.0, 1.0, 120.0, 2.0
"""Driven back means, at samples 0.5 m apart: within 1 m of where the path was 5 m or more of way earlier, in a
direction that differs by more than theta_back (Eq. 4) from that there. A stretch of 2 m or more is a deviation."""

DEFINITIONS = {
    "imaged": "Mean over the true clusters of the share of their oysters' area that came into the true camera's "
    "picture: inside both angles of view, not hidden by an obstacle, within 6 m (the paper's detection range) and "
    "within the water's visibility.",
    "inspected": "The same at a resolution at which an ecologist counts oysters: pixels of at most 0.05 m, that is, "
    "from at most 2.3 m with the default camera.",
    **{f"time_to_{100 * s:.0f}_s": f"Simulated time (s) until {s:.0%} was inspected; null if never." for s in SHARES},
    **{f"inspected_at_{s}_s": f"Share that was inspected after {s} s of simulated time." for s in BUDGETS_S},
    "inspected_auc": "Area under the curve of `inspected`: its mean over the first 600 s, the last value held.",
    "oracle_ratio_90": "time_to_90_s over that of an oracle, which knows the reef and drives a short tour past all of "
    "it at cruise speed. The tour is a heuristic, not a proven optimum; null where 90 % was not inspected.",
    "idle_fraction": "Share of the time that the vehicle stood still: less than 0.05 m/s over ground, turning or not.",
    "path_deviations": "Deviations of the path that was driven, whatever was adopted: times that it went farther than "
    "3 m from the reef, and stretches of 2 m or more driven back along itself.",
    "phantom_clusters": "Clusters on the robot's map at the end that match no true one (no oyster within 1 m).",
    "position_error_m": "Distance between the position that the robot believed at the end and the true one (m).",
    "odometry_error_m": "The same distance for the odometry alone, before correction (m).",
    "corrected_m": "Distance between the position that the robot believed at the end and that of its odometry (m).",
    "all_covered_s": "Simulated time (s) at which every cluster counted as covered, where `--cfg.stop-when-covered` "
    "would end a mission; null where it never came to that.",
    "late_calls": "Questions put to the advisor after everything was inspected (time_to_100_s); null if it never was.",
}
"""Definitions of the metrics, for the report."""


def outcome_metrics(folder: Path, events: Sequence[Mapping[str, Any]], rows: Sequence[Row]) -> dict[str, Any]:
    """Compute the judge's metrics. Those whose input was not recorded are None."""
    t, imaged, inspected, reef_m = _judged(folder / SurveyFiles.JUDGE)
    judged: Mapping[str, Any] = next((e for e in reversed(events) if e["event"] == "judged"), {})
    times = {f"time_to_{100 * s:.0f}_s": time_to(t, inspected, s) for s in SHARES}
    best = judged.get("oracle_time_to_90_s")
    soon = times["time_to_90_s"]
    path = np.array([(float(row["x"]), float(row["y"])) for row in rows]).reshape(-1, 2)
    speeds = [math.hypot(float(row.get("u", "nan")), float(row.get("v", "nan"))) for row in rows]
    return {
        "imaged": round(float(imaged[-1]), 4) if len(t) else None,
        "inspected": round(float(inspected[-1]), 4) if len(t) else None,
        **times,
        **{f"inspected_at_{s}_s": share_at(t, inspected, s) for s in BUDGETS_S},
        "inspected_auc": area_under(t, inspected),
        "oracle_ratio_90": round(soon / best, 3) if soon is not None and best else None,
        "idle_fraction": round(sum(v < IDLE_M_S for v in speeds) / len(speeds), 4) if speeds else None,
        "path_deviations": excursions(reef_m) + driven_back(path),
        "phantom_clusters": judged.get("phantoms"),
        "position_error_m": _position_error(rows, "est"),
        "odometry_error_m": _position_error(rows, "odo"),
        "corrected_m": _corrected(rows),
        "all_covered_s": _all_covered_s(events),
        "late_calls": _asked_after(times["time_to_100_s"], events),
    }


def time_to(t: NDArray[np.float64], share: NDArray[np.float64], wanted: float) -> float | None:
    """Return the time (s) at which a growing share first reached a value; None if never. t, share: Shape=(N,)."""
    reached = np.flatnonzero(share >= wanted - 1e-6)
    return round(float(t[reached[0]]), 3) if reached.size else None


def share_at(t: NDArray[np.float64], share: NDArray[np.float64], at_s: float) -> float | None:
    """Return a growing share at a time (s), its last value held; None without any. t, share: Shape=(N,)."""
    return round(float(share[np.searchsorted(t, at_s, side="right") - 1]), 4) if len(t) and t[0] <= at_s else None


def area_under(t: NDArray[np.float64], share: NDArray[np.float64], horizon_s: float = HORIZON_S) -> float | None:
    """Return the mean of a step function over the first `horizon_s`, last value held. t, share: Shape=(N,)."""
    if not len(t):
        return None
    ends = np.minimum(np.append(t[1:], max(horizon_s, float(t[-1]))), horizon_s)
    return round(float((share * np.maximum(ends - np.minimum(t, horizon_s), 0.0)).sum() / horizon_s), 4)


def excursions(reef_m: NDArray[np.float64]) -> int:
    """Count how often a robot left the reef. reef_m: its distance from the reef at every tick (m), Shape=(N,)."""
    count, out = 0, False
    for distance in reef_m.tolist():
        if not out and distance > OFF_ROUTE_M:
            count, out = count + 1, True
        elif out and distance < BACK_ON_M:
            out = False
    return count


def driven_back(path: NDArray[np.float64]) -> int:
    """Count the stretches that were driven back along the path itself. path: Shape=(N, 2)."""
    if len(path) < 2:
        return 0
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    at = np.arange(0.0, float(way[-1]), SAMPLE_M)
    places = np.stack([np.interp(at, way, path[:, k]) for k in range(2)], axis=1)
    if len(places) < 2:
        return 0
    along = np.diff(places, axis=0)
    heading, places = np.arctan2(along[:, 1], along[:, 0]), places[:-1]
    back = np.zeros(len(places), bool)
    lag = round(EARLIER_M / SAMPLE_M)
    for k in range(lag, len(places)):
        near = np.hypot(*(places[: k - lag + 1] - places[k]).T) < BESIDE_M
        turn = np.abs(np.remainder(heading[: k - lag + 1] - heading[k] + math.pi, 2.0 * math.pi) - math.pi)
        back[k] = bool((near & (turn > math.radians(BACK_DEG))).any())
    edges = np.flatnonzero(np.diff(np.concatenate([[0], back.astype(int), [0]])))
    lengths = (edges[1::2] - edges[::2]) * SAMPLE_M
    return int((lengths >= STRETCH_M).sum())


def _position_error(rows: Sequence[Row], of: str) -> float | None:
    """Return the distance (m) of the last estimate (est, odo) from the true position; None if it was not recorded.

    A tick's estimate is of where the last one ended. Where nobody knows the truth, there is no column of estimates: x
    and y are what the robot believed.
    """
    if len(rows) < 2 or "est_x" not in rows[0] or f"{of}_x" not in rows[0]:
        return None
    true, believed = rows[-2], rows[-1]
    there = float(believed[f"{of}_x"]), float(believed[f"{of}_y"])
    return round(math.dist((float(true["x"]), float(true["y"])), there), 4)


def _corrected(rows: Sequence[Row]) -> float | None:
    if not rows or "odo_x" not in rows[-1]:
        return None
    last, believed = rows[-1], "est_" if "est_x" in rows[-1] else ""
    there, alone = ((float(last[f"{of}x"]), float(last[f"{of}y"])) for of in (believed, "odo_"))
    return round(math.dist(there, alone), 4)


def _all_covered_s(events: Sequence[Mapping[str, Any]]) -> float | None:
    """Return the time at which the experimenter would stop."""
    total = next((int(event["clusters_total"]) for event in events if event["event"] == "start"), 0)
    covered = [float(event["t"]) for event in events if event["event"] == "cluster_covered"]
    return round(covered[total - 1], 3) if 0 < total <= len(covered) else None


def _asked_after(t: float | None, events: Iterable[Mapping[str, Any]]) -> int | None:
    return None if t is None else sum(event["event"] == "question" and float(event["t"]) > t for event in events)


def _judged(path: Path) -> tuple[NDArray[np.float64], ...]:
    """Return the columns t, imaged, inspected and reef_m of judge.csv, as far as written. Shape=(N,) each."""
    rows: list[tuple[float, ...]] = []
    if path.is_file():
        table = csv.DictReader(line for line in read_log_lines(path) if line.endswith("\n"))
        rows = [tuple(float(row[name]) for name in ("t", "imaged", "inspected", "reef_m")) for row in table]
    return tuple(np.array(rows, np.float64).reshape(-1, 4).T)

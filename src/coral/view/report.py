"""The report of a reef survey: one self-contained page."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from coral.advisor.attribution import who_decided
from coral.advisor.fallback import FOR_RUNS, Fallback
from coral.foreign_file import read_text
from coral.reef.decide.said import said_by
from coral.reef.mission.events import guesses_told, place_told, sight_told, unjudged
from coral.reef.mission.metrics import DEFINITIONS, OWN_MAP, metrics_of
from coral.reef.mission.outcome import outcome_metrics
from coral.run_files import SurveyFiles
from coral.view.decisions import Decision, decisions
from coral.view.figures import clearance_chart, coverage_chart, event_chart, imaging_chart, speed_chart
from coral.view.mapsvg import MapSvg, cluster_fate
from coral.view.page import TEMPLATES, metric_rows, origin, render_page, write_page
from coral.view.run import Record, RunFolder
from coral.view.runmap import write_map
from coral.view.time_slider import script_data, shown_pictures
from coral.words import clock, many

TIMING = ("wall_time_s", "realtime_factor", "control_ms_median", "control_ms_p99")
EXACT_M = 0.005
"""Position errors below this are rounding."""
IMAGING = "Imaged and inspected"
IMAGING_NOTE = (
    "Share of the true oyster area that came into the camera's picture within 6 m (imaged), and near enough to count "
    "oysters (inspected: pixels of 0.05 m or less). Dots: 50, 80, 90 and 100 % inspected."
)


def write_report(run_folder: str | Path) -> Path:
    """Write `report.html` and `map.png` into a run folder, finished or killed, and return the page's path.

    The page contains its pictures, styles and script, and loads nothing from elsewhere. Existing files are replaced.

    Raises:
        InputError: There is no run in the folder, or the page cannot be written.
    """
    run = RunFolder.read(run_folder)
    write_map(run)
    return write_page(run.path, render_report(run))


def render_report(run: RunFolder) -> str:
    """Render the whole page as text."""
    made = decisions(run)
    pictures = shown_pictures(run, made)
    metrics, mission = run.figures(partial(_metrics_so_far, run.path)), _mission(run)
    drawing = MapSvg(run, _size(run))
    start: Record = (run.select("start") or [{}])[0]
    collisions = len(run.select("collision"))
    return render_page(
        "report.html.j2",
        run=run,
        name=str(start.get("world") or run.config.get("world") or run.path.name),
        topology=str(run.world.get("topology", "")),
        size=_size(run),
        metrics=metrics,
        headline=_headline(run, metrics),
        tiles=_tiles(metrics, mission, own=_by_own_map(run)),
        map=Markup(drawing.draw(made)),
        decisions=made,
        charts=[(title, note, Markup(svg)) for title, note, svg in _charts(run, made)],
        pictures=pictures,
        rows=metric_rows(metrics, DEFINITIONS),
        truth=_truth_counts(run),
        truth_known=not _by_own_map(run),
        mission=mission,
        states=_states(run),
        left=[] if mission else _left(run),
        collisions=collisions,
        **origin(run, ("world", "advisor", "variant", "seed"), TIMING),
        data=Markup(script_data(run, made, pictures)),
        has_frames=run.kept_pictures,
        has_colours=any(run.frame(step, "rgb") is not None for step in run.frame_steps[:1]),
        video=(run.path / SurveyFiles.VIDEO).is_file(),
        script=Markup(read_text(TEMPLATES / "report.js", "a file of this package")),
    )


def _metrics_so_far(path: Path, events: Sequence[Record], rows: Sequence[Mapping[str, str]]) -> Mapping[str, Any]:
    return {**metrics_of(events, rows), **outcome_metrics(path, events, rows), "end_reason": "interrupted"}


def _size(run: RunFolder) -> tuple[float, float]:
    """Return the extent of the map (m): from the world, else from the last snapshot, else from the trajectory."""
    size = run.world.get("size_m")
    if isinstance(size, list | tuple) and len(size) == 2:
        return float(size[0]), float(size[1])
    x, y = run.column("x"), run.column("y")
    reach = [float(np.nanmax(a)) if np.isfinite(a).any() else 0.0 for a in (x, y)]
    return max(10.0, math.ceil(reach[0] + 2)), max(10.0, math.ceil(reach[1] + 2))


def _by_own_map(run: RunFolder) -> bool:
    """Whether nobody knows the truth: coverage and contacts are by the vehicle's own map, as in real water."""
    return any(e.get("judged_by") == OWN_MAP for e in run.select("start"))


def _headline(run: RunFolder, metrics: Mapping[str, Any]) -> str:
    if not metrics or not metrics.get("steps"):
        return "Nothing was recorded yet."
    covered, total = int(metrics.get("clusters_covered", 0)), int(metrics.get("clusters_total", 0))
    touched = int(metrics.get("collisions") or 0)
    found = f"{covered} of {many(total, 'oyster cluster')}"
    if total and covered == total:
        found = f"all {total} oyster clusters" if total > 1 else "the only oyster cluster"
    safe = ", without touching anything" if not touched else f", with {many(touched, 'collision')}"
    if _by_own_map(run):
        found, safe = f"{found} of its own map", ""
    had = "" if run.complete else "had "
    verb = f"{had}covered {found} and surveyed" if total or not run.select("instruction") else f"{had}travelled"
    asked = many(int(metrics.get("advisor_calls", 0)), "question")
    minutes, seconds = divmod(round(float(metrics.get("sim_time_s", 0.0))), 60)
    distance = float(metrics.get("distance_m", 0.0))
    lasted = f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
    told = [f"The robot {verb} for {lasted} over {distance:.0f} m{safe}, putting {asked} to its advisor."]
    deciding = who_decided(metrics, things="goals", fallback=_fallback(run), advisor="The advisor")
    told += [f"{deciding[0].upper()}{deciding[1:]}."] if deciding else []
    if phantoms := int(metrics.get("phantom_clusters") or 0):
        mapped = "of the clusters that it mapped"
        told.append(f"{phantoms} {mapped} are no oysters." if phantoms > 1 else f"One {mapped} is no oysters.")
    for event in run.select("sight")[-1:]:
        seen = f"By the last pictures, {sight_told(event)}."
        told = [f"Not judged. {seen}", *told] if unjudged(event) else [*told, seen]
    if guesses := guesses_told(run.select("guess")):
        told.append(f"{guesses[0].upper()}{guesses[1:]}.")
    told += [f"Saved map: {place_told(event)}." for event in run.select("place")[-1:]]
    return " ".join(told)


def _fallback(run: RunFolder) -> Fallback:
    """Return the fallback policy of the run, if its configuration names one."""
    try:
        found: Fallback = run.config["mission"]["pilot"]["fallback"]
    except (KeyError, TypeError):
        return FOR_RUNS
    return found


def _tiles(metrics: Mapping[str, Any], mission: Mapping[str, Any], *, own: bool) -> list[tuple[str, str, str, str]]:
    """Return (value, unit or remark, name, state) of the key numbers, which may be by the vehicle's own map."""
    if not metrics:
        return []
    covered, total = int(metrics.get("clusters_covered", 0)), int(metrics.get("clusters_total", 0))
    collisions = metrics.get("collisions", 0)
    closest = metrics.get("min_clearance_m")
    whole = "good" if total and covered == total else ""
    of_clusters = f"{covered} of {total} clusters{' of its own map' if own else ''}"
    covering = (f"{float(metrics.get('coverage', 0)):.0%}", of_clusters, "coverage", whole)
    if mission and not total:  # a reef without oysters
        met = sum(verdict == "met" for _, verdict, _ in mission["rows"])
        covering = (mission["verdict"], f"{met} of {len(mission['rows'])} conditions met", "mission", "")
    passed = f"{closest:.2f} m" if isinstance(closest, int | float) else "none seen"
    safe = (str(collisions), f"closest pass {passed}", "collisions", "bad" if collisions else "good")
    if own:
        safe = (passed, "from its hull to obstacles of its own map; contacts are not judged", "closest pass", "")
    again = f"{many(int(metrics.get('requeries', 0)), 're-query', 're-queries')} among them"
    return [
        covering,
        safe,
        (
            clock(float(metrics.get("sim_time_s", 0))),
            "minutes" if "late_ticks" in metrics else "minutes, simulated",
            "survey time",
            "",
        ),
        (f"{float(metrics.get('distance_m', 0)):.0f} m", "along the path", "distance", ""),
        (str(metrics.get("advisor_calls", 0)), again, "advisor calls", ""),
        (str(metrics.get("deviations", 0)), "beyond the paper's fixed angles", "deviations", ""),
        *(_inspection_tiles(metrics) if total or not mission else ()),
        *_position_tiles(metrics),
    ]


def _inspection_tiles(metrics: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Return the tiles of the inspected share and of idle time; none for a run without them."""
    share, soon, ratio = (metrics.get(key) for key in ("inspected", "time_to_90_s", "oracle_ratio_90"))
    if not isinstance(share, int | float):
        return []
    remark = "90 % not reached" if soon is None else f"90 % at {clock(float(soon))}"
    remark += f", {ratio:.1f} × oracle" if isinstance(ratio, int | float) else ""
    tiles = [(f"{share:.0%}", remark, "inspected", "")]
    idle = metrics.get("idle_fraction")
    if isinstance(idle, int | float):
        tiles.append((f"{idle:.0%}", "of the time, below 0.05 m/s", "standing still", ""))
    return tiles


def _position_tiles(metrics: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Return the tile of the position's error, or of what was corrected; none where the odometry is exact."""
    error, odometry, corrected, sigma = (
        metrics.get(key) for key in ("position_error_m", "odometry_error_m", "corrected_m", "position_sigma_m")
    )
    if isinstance(error, int | float) and isinstance(odometry, int | float):
        told = f"odometry alone {odometry:.2f} m"
        return [] if odometry < EXACT_M else [(f"{error:.2f} m", told, "position error at the end", "")]
    if not isinstance(corrected, int | float) or corrected < EXACT_M:
        return []
    told = "by the localizer; nobody knows the error"
    told += f", it reckons with {sigma:.2f} m" if isinstance(sigma, int | float) else ""
    return [(f"{corrected:.2f} m", told, "position corrected at the end", "")]


def _charts(run: RunFolder, made: Sequence[Decision]) -> list[tuple[str, str, str]]:
    if not len(run.column("t")) and not run.events:
        return []
    bare = bool(run.select("instruction")) and not _truth_counts(run)
    imaging = "" if bare else imaging_chart(run)
    own = _by_own_map(run)
    clusters = "oyster clusters on the vehicle's own map" if own else "true oyster clusters"
    covering = f"Share of the {clusters} of which at least 60 % has been seen; each mark is one."
    return [
        *([] if bare else [("Coverage", covering, coverage_chart(run))]),
        *([(IMAGING, IMAGING_NOTE, imaging)] if imaging else []),
        (
            "Decisions and triggers",
            "Dots: a trigger fired, and the advisor was asked unless it had left the rest to the robot. Thin bars: a "
            "trigger was held back. Wide bars: waiting for the advisor, coloured by verdict; meanwhile the vehicle "
            "drives on to its goal, and stops there. Incidents: collisions, motions that could not be planned, paths "
            "that were planned anew because the robot had left them, decisions of the fallback.",
            event_chart(run, made),
        ),
        ("Speed", "Speed over ground and the controller's command.", speed_chart(run)),
        (
            "Clearance",
            f"{'Distance' if own else 'True distance'} between the robot's hull (a 0.3 m disc) and the nearest obstacle"
            f"{' on its own map' if own else ''}. "
            "Shaded: nearer than the hull's own radius; at 0 m (red line) it touches.",
            clearance_chart(run),
        ),
    ]


def _truth_counts(run: RunFolder) -> Counter[str]:
    """Count true clusters by what became of them."""
    clusters = run.world.get("clusters")
    known = [one for one in clusters if isinstance(one, dict) and one.get("oysters")] if clusters else []
    return Counter(cluster_fate(run, one)[0] for one in known)


def _mission(run: RunFolder) -> dict[str, Any]:
    """Return instruction, answer, marks and verdict of a mission in words; empty for another mission."""
    told = run.select("instruction")
    judged: Record = next(
        (e["instruction"] for e in run.select("judged") if isinstance(e.get("instruction"), dict)), {}
    )
    if not told and not judged:
        return {}
    rows = [
        (str(one.get("condition", "")).replace("_", " "), "met" if one.get("met") else "not met", str(one.get("found")))
        for one in judged.get("conditions") or ()
        if isinstance(one, dict)
    ]
    met = judged.get("met")
    changes = [(clock(float(e["t"])), str(e.get("by", "")), str(e.get("text", ""))) for e in told]
    return {
        "text": changes[-1][-1] if changes else str(judged.get("text", "")),
        "changes": changes if len(changes) > 1 else [],
        "verdict": "not judged" if met is None else "fulfilled" if met else "not fulfilled",
        "answer": judged.get("answer"),
        "rows": rows,
        "unjudged": "at sea nobody knows the truth" if _by_own_map(run) else "no conditions are known for these words",
        "marks": [
            (str(one.dot), f"({one.x:.1f}, {one.y:.1f}) m", one.label or "–", "yes" if one.skip else "", one.why)
            for one in said_by(run.events)
        ],
    }


def _states(run: RunFolder) -> list[tuple[str, str, str, str]]:
    """Return (time, state, who, why) of every change; nothing if the vehicle surveyed from start to end."""
    changes = [
        (clock(float(e["t"])), str(e.get("state", "")), str(e.get("by", "")), str(e.get("reason", "")))
        for e in run.select("state")
    ]
    return changes if any(state not in ("surveying", "stopped") for _, state, _, _ in changes) else []


def _left(run: RunFolder) -> list[tuple[str, str]]:
    """Return (name, reason) of every cluster that the robot knew of and did not finish."""
    told = run.select("left")
    clusters = told[-1].get("clusters") if told else None
    return [
        (f"{one.get('index')} at ({one.get('x')}, {one.get('y')}) m", str(one.get("why", "")))
        for one in (clusters if isinstance(clusters, list) else [])
        if isinstance(one, dict)
    ]

"""The report of a reef survey: one self-contained page."""

from __future__ import annotations

import json
import math
import os
from base64 import b64encode
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2
import jinja2
import numpy as np
import yaml
from markupsafe import Markup

from coral.advisor.attribution import who_decided
from coral.advisor.fallback import FOR_RUNS, Fallback
from coral.errors import InputError
from coral.odd_text import encodable
from coral.reef.metrics import DEFINITIONS, fleet_metrics, metrics_of
from coral.reef.outcome import outcome_metrics
from coral.view.cameraview import DEPTH_PALETTE, LABEL_COLORS, depth_levels
from coral.view.decisions import Decision, decisions
from coral.view.figures import (
    HELD,
    clearance_chart,
    control_histogram,
    coverage_chart,
    event_chart,
    speed_chart,
)
from coral.view.imaging_chart import imaging_chart
from coral.view.mapsvg import MapSvg, color_of, map_uri
from coral.view.pictures import palette_png
from coral.view.run import Record, RunFolder
from coral.view.svg import LEFT, RIGHT, WIDTH, clock
from coral.words import many

TEMPLATES = Path(__file__).parent / "templates"
FRAME_BUDGET = 3_000_000
"""Bytes of page that the time slider's snapshots may take."""
PICTURE_BUDGET = 3_000_000
"""Bytes of page that the pictures shown to the advisor may take."""
PICTURE_SIZES = ((768, 80), (560, 75), (400, 65), (280, 55))
"""(Width px, quality) tried in turn until the pictures fit."""


EXACT_M = 0.005
"""Position errors below this are rounding."""
IMAGING = "Imaged and inspected"
IMAGING_NOTE = (
    "Share of the true oyster area that came into the camera's picture within 6 m (faint), and near enough to count "
    "oysters (strong; pixels of 0.05 m or less). Dots: 50, 80, 90 and 100 % inspected."
)


def write_report(run_folder: str | Path) -> Path:
    """Write `report.html` into a run folder, finished or killed, and return its path.

    The page holds its pictures, styles and script; it loads nothing from anywhere. A report that is there already
    is replaced.

    Raises:
        InputError: There is no run in the folder, or the page cannot be written.
    """
    run = RunFolder.read(run_folder)
    return write_page(run.path, render_report(run))


def write_page(folder: Path, page: str) -> Path:
    """Write `report.html` atomically and return its path.

    Raises:
        InputError: It cannot be written.
    """
    path = folder / "report.html"
    partial = path.with_name("report.html.part")
    try:
        partial.write_text(encodable(page), encoding="utf-8")
        os.replace(partial, path)
    except OSError as error:
        raise InputError(str(path), "", error.strerror or error, "a file that can be written") from None
    return path


def render_report(run: RunFolder) -> str:
    """Render the whole page as text."""
    made = decisions(run)
    pictures = _pictures(run, made)
    metrics = _metrics(run)
    drawing = MapSvg(run, _size(run))
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["clock"] = clock
    page = environment.get_template("report.html.j2")
    start: Record = (run.select("start") or [{}])[0]
    collisions = len(run.select("collision", "robot_collision"))
    return page.render(
        run=run,
        name=str(start.get("world") or run.config.get("world") or run.path.name),
        topology=str(run.world.get("topology", "")),
        size=_size(run),
        metrics=metrics,
        headline=_headline(run, metrics),
        tiles=_tiles(metrics),
        map=Markup(drawing.draw(made)),
        decisions=made,
        charts=[(title, note, Markup(svg)) for title, note, svg in _charts(run, made)],
        histogram=Markup(control_histogram(run.timing)),
        pictures=pictures,
        rows=[
            (_title(key), _show(key, value), DEFINITIONS.get(key, ""))
            for key, value in metrics.items()
            if key != "per_robot"
        ],
        each=_each(metrics),
        robots=[color_of(k) for k in range(1, len(run.fleet) + 1)],
        truth=_truth_counts(run),
        collisions=collisions,
        provenance=_provenance(run, start),
        config=yaml.safe_dump(dict(run.config), sort_keys=False, allow_unicode=True) if run.config else "",
        data=Markup(_script_data(run, made, pictures)),
        held=HELD,
        has_frames=bool(run.frame_steps),
        video=(run.path / "mission.mp4").is_file(),
        script=Markup((TEMPLATES / "report.js").read_text("utf-8")),
        style=Markup((TEMPLATES / "report.css").read_text("utf-8")),
    )


def _metrics(run: RunFolder) -> Mapping[str, Any]:
    """Return the run's own metrics, or those that the recorded part allows."""
    if run.metrics:
        return run.metrics
    tables = []
    for table in (run.trajectory, *run.fleet):
        columns = [table[name].tolist() for name in table]
        tables.append([dict(zip(table, map(str, values), strict=True)) for values in zip(*columns, strict=True)])
    try:
        found = fleet_metrics(run.events, tables) if run.fleet else metrics_of(run.events, tables[0])
        return {**found, **outcome_metrics(run.path, run.events, tables), "end_reason": "interrupted"}
    except (KeyError, ValueError, TypeError):
        return {}


def _size(run: RunFolder) -> tuple[float, float]:
    """Return the extent of the map (m): from the world, else from the last snapshot, else from the trajectory."""
    size = run.world.get("size_m")
    if isinstance(size, list | tuple) and len(size) == 2:
        return float(size[0]), float(size[1])
    x, y = run.column("x"), run.column("y")
    reach = [float(np.nanmax(a)) if np.isfinite(a).any() else 0.0 for a in (x, y)]
    return max(10.0, math.ceil(reach[0] + 2)), max(10.0, math.ceil(reach[1] + 2))


def _headline(run: RunFolder, metrics: Mapping[str, Any]) -> str:
    if not metrics or not metrics.get("steps"):
        return "Nothing was recorded that could be reported on yet."
    covered, total = int(metrics.get("clusters_covered", 0)), int(metrics.get("clusters_total", 0))
    touched = int(metrics.get("collisions", 0))
    found = f"all {total}" if total and covered == total else f"{covered} of {total}"
    safe = "without touching anything" if not touched else f"with {many(touched, 'collision')}"
    verb = "had covered" if not run.complete else "covered"
    asked = many(int(metrics.get("advisor_calls", 0)), "question")
    minutes, seconds = divmod(int(float(metrics.get("sim_time_s", 0.0))), 60)
    distance = float(metrics.get("distance_m", 0.0))
    who, whose = (f"the {metrics['robots']} robots", "their") if metrics.get("robots") else ("the robot", "its")
    deciding = who_decided(metrics, things="goals", fallback=_fallback(run), advisor="The advisor")
    return (
        f"In {minutes} min {seconds} s {who} {verb} {found} oyster clusters over {distance:.0f} m of survey, "
        f"{safe}, putting {asked} to {whose} advisor.{f' {deciding}.' if deciding else ''}"
    )


def _fallback(run: RunFolder) -> Fallback:
    """Return the fallback policy of the run, if its configuration names one."""
    try:
        found: Fallback = run.config["mission"]["pilot"]["fallback"]
    except (KeyError, TypeError):
        return FOR_RUNS
    return found


def _tiles(metrics: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Return (value, unit or remark, name, state) of the key numbers."""
    if not metrics:
        return []
    covered, total = int(metrics.get("clusters_covered", 0)), int(metrics.get("clusters_total", 0))
    collisions = int(metrics.get("collisions", 0))
    closest = metrics.get("min_clearance_m")
    return [
        (
            f"{float(metrics.get('coverage', 0)):.0%}",
            f"{covered} of {total} clusters",
            "coverage",
            "good" if total and covered == total else "",
        ),
        (
            str(collisions),
            f"closest pass {closest:.2f} m" if isinstance(closest, int | float) else "",
            "collisions",
            "bad" if collisions else "good",
        ),
        (clock(float(metrics.get("sim_time_s", 0))), "minutes, simulated", "survey time", ""),
        (f"{float(metrics.get('distance_m', 0)):.0f} m", "along the path", "distance", ""),
        (
            str(metrics.get("advisor_calls", 0)),
            f"{metrics.get('requeries', 0)} of them re-queries",
            "advisor calls",
            "",
        ),
        (
            str(metrics.get("deviations", 0)),
            "off the reef's trend",
            "deviations",
            "bad" if metrics.get("deviations") else "",
        ),
        *_inspected(metrics),
        *_located(metrics),
    ]


def _inspected(metrics: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Return the tiles of the inspected share and of standing still; none for a run that was not judged."""
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


def _located(metrics: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Return the tile of the position error; none where the odometry is exact."""
    error, odometry = metrics.get("position_error_m"), metrics.get("odometry_error_m")
    if not isinstance(error, int | float) or not isinstance(odometry, int | float) or odometry < EXACT_M:
        return []
    return [(f"{error:.2f} m", f"odometry alone {odometry:.2f} m", "position error at the end", "")]


def _each(metrics: Mapping[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Return head and rows of a table of every robot's own figures; empty for one robot."""
    each = [one for one in metrics.get("per_robot") or () if isinstance(one, dict)]
    if not each:
        return [], []
    return [_title(key) for key in each[0]], [[_show(key, value) for key, value in one.items()] for one in each]


def _title(key: str) -> str:
    """Return a metric's key in words, its unit in brackets."""
    for suffix, unit in (("_m_s", "m/s"), ("_ms", "ms"), ("_s", "s"), ("_m", "m")):
        if key.endswith(suffix):
            return f"{key.removesuffix(suffix).replace('_', ' ')} ({unit})"
    return key.replace("_", " ")


def _show(key: str, value: object) -> str:
    if value is None:
        return "–"
    if key in ("coverage", "imaged", "inspected") and isinstance(value, int | float):
        return f"{value:.1%}"
    if isinstance(value, float):
        return f"{value:,.3f}".rstrip("0").rstrip(".")
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {count}" for name, count in value.items())
    return str(value)


def _charts(run: RunFolder, made: Sequence[Decision]) -> list[tuple[str, str, str]]:
    if not len(run.column("t")) and not run.events:
        return []
    first = " of robot 0" if run.fleet else ""
    imaging = imaging_chart(run)
    return [
        (
            "Coverage",
            "Share of the true oyster clusters of which at least 60 % has been seen; each mark is one.",
            coverage_chart(run),
        ),
        *([(IMAGING, IMAGING_NOTE, imaging)] if imaging else []),
        (
            "Decisions and triggers",
            "Dots: the advisor was asked. Thin bars: a trigger was held back. Wide bars: the advisor thinking, "
            "coloured by verdict; the controller goes on meanwhile.",
            event_chart(run, made),
        ),
        (f"Speed{first}", "Speed over ground and the controller's command.", speed_chart(run)),
        (
            f"Clearance{first}",
            "True distance between the robot's hull (a 0.3 m disc) and the nearest obstacle. "
            "Shaded: nearer than the hull's own radius; at 0 m (red line) it touches.",
            clearance_chart(run),
        ),
    ]


def _truth_counts(run: RunFolder) -> tuple[int, int]:
    """Return (covered, missed) true clusters."""
    clusters = run.world.get("clusters")
    total = len(clusters) if isinstance(clusters, list) else 0
    covered = len({str(e.get("name")) for e in run.select("cluster_covered")})
    return covered, max(0, total - covered)


def _provenance(run: RunFolder, start: Record) -> list[tuple[str, str]]:
    origin = run.config.get("provenance")
    facts: list[tuple[str, object]] = [
        (key, start.get(key, run.config.get(key))) for key in ("world", "advisor", "variant", "seed")
    ]
    facts += list(origin.items()) if isinstance(origin, dict) else []
    facts += [
        (key, run.timing.get(key)) for key in ("wall_time_s", "realtime_factor", "control_ms_median", "control_ms_p99")
    ]
    return [(key.replace("_", " "), str(value)) for key, value in facts if value not in (None, "")]


def _pictures(run: RunFolder, made: Sequence[Decision]) -> dict[str, str]:
    """Return data URLs of the pictures that were shown, by digest; the more pictures, the smaller each one."""
    wanted = {digest for d in made for one in d.tries for _, digest in one.pictures}
    found = {digest: path for digest in sorted(wanted) if (path := run.picture(digest)) is not None}
    images = {digest: image for digest, path in found.items() if (image := cv2.imread(str(path))) is not None}
    encoded: dict[str, bytes] = {}
    for width, quality in PICTURE_SIZES:
        encoded = {}
        for digest, image in images.items():
            scale = min(1.0, width / image.shape[1])
            small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA) if scale < 1 else image
            encoded[digest] = cv2.imencode(".webp", small, [cv2.IMWRITE_WEBP_QUALITY, quality])[1].tobytes()
            if sum(map(len, encoded.values())) > PICTURE_BUDGET * 3 // 4:
                break
        if len(encoded) == len(images):
            break
    return {digest: "data:image/webp;base64," + b64encode(data).decode() for digest, data in encoded.items()}


def _script_data(run: RunFolder, made: Sequence[Decision], pictures: Mapping[str, str]) -> str:
    """Return the data of the time slider, as JSON that is safe inside a script element."""
    t = run.column("t")
    stride = max(1, -(-len(t) // 1500))
    keep = np.unique(np.append(np.arange(0, len(t), stride), max(len(t) - 1, 0))) if len(t) else np.zeros(0, int)
    speed = np.hypot(run.column("u"), run.column("v"))

    def column(values: Any, digits: int) -> list[float | None]:
        return [round(float(v), digits) if math.isfinite(v) else None for v in values[keep]]

    data = {
        "t": column(t, 2),
        "x": column(run.column("x"), 3),
        "y": column(run.column("y"), 3),
        "a": column(run.column("theta"), 3),
        "s": column(speed, 3),
        "c": column(run.column("clearance"), 2),
        "k": column(run.column("coverage"), 4),
        "gx": column(run.column("goal_x"), 2),
        "gy": column(run.column("goal_y"), 2),
        "end": round(run.duration_s, 2),
        "plot": [LEFT, WIDTH - RIGHT, WIDTH],
        **({"o": [_motion(run.robot(k), keep) for k in range(1, len(run.fleet) + 1)]} if run.fleet else {}),
        "frames": _frames(run),
        "pictures": dict(pictures),
        "decisions": [
            {
                "n": d.number,
                "t": d.t,
                "end": d.end_s,
                "mode": d.mode,
                "cause": d.cause,
                "tries": len(d.tries),
                "said": d.tries[-1].said,
                **({"r": d.robot} if run.fleet else {}),
                "verdict": d.outcome,
                "why": d.tries[-1].why[:600],
                "c": [[c["index"], c["x"], c["y"], bool(c.get("visited"))] for c in d.centroids],
            }
            for d in made
        ],
    }
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def _motion(run: RunFolder, keep: Any) -> dict[str, list[float]]:
    """Return another robot's motion at the samples `keep`, held at its last one; empty without any."""
    length = len(run.column("t"))
    at = np.minimum(keep, length - 1) if length else np.zeros(0, int)
    return {
        key: np.nan_to_num(run.column(name)[at]).round(3).tolist()
        for key, name in (("x", "x"), ("y", "y"), ("a", "theta"))
    }


def _frames(run: RunFolder) -> list[dict[str, Any]]:
    """Return snapshots for the time slider, as many as the budget allows, the last one always included."""
    steps = list(run.frame_steps)
    if not steps:
        return []
    times = dict(zip(run.column("step").tolist(), run.column("t").tolist(), strict=True))
    rate = _seconds_per_step(run)
    stride = 1
    while True:
        chosen = sorted({*steps[::stride], steps[-1]})
        frames, size = [], 0
        for step in chosen:
            frame = {"t": round(times.get(float(step), step * rate), 2), **_snapshot(run, step)}
            size += sum(len(value) for value in frame.values() if isinstance(value, str))
            if size > FRAME_BUDGET:
                break
            frames.append(frame)
        else:
            return frames
        stride = max(stride + 1, math.ceil(stride * len(chosen) / max(len(frames), 1)))


def _seconds_per_step(run: RunFolder) -> float:
    steps, t = run.column("step"), run.column("t")
    return float(t[-1] / steps[-1]) if len(steps) and steps[-1] > 0 and math.isfinite(t[-1]) else 0.1


def _snapshot(run: RunFolder, step: int) -> dict[str, str]:
    """Return small pictures of one moment as data URLs; unreadable ones are left out."""
    found = {}
    cells, labels, depth = (run.frame(step, kind) for kind in ("map", "labels", "depth"))
    if cells is not None:
        found["map"] = map_uri(cells)
    for key, image in (("seg", (labels, LABEL_COLORS)), ("dep", (depth, DEPTH_PALETTE))):
        values, palette = image
        if values is None:
            continue
        classes = depth_levels(np.asarray(values * 1e-3, np.float32)) // 8 * 8 if key == "dep" else values
        # Coarser depth steps compress to a third; the pure "nothing" colour keeps its own entry.
        if key == "dep":
            classes = np.where(values == 0, 255, classes).astype(np.uint8)
        found[key] = (
            "data:image/png;base64," + b64encode(palette_png(np.minimum(classes, len(palette) - 1), palette)).decode()
        )
    return found

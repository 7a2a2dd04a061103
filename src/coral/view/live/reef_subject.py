"""A reef survey for the viewer: map, robot, the true reef, and what its events say."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from coral.reef.decide.said import said_by
from coral.reef.mission.metrics import OWN_MAP
from coral.view.decisions import CAUSES, Try
from coral.view.live.stream import Moment, Subject
from coral.view.mapsvg import outlines
from coral.view.run import Record, RunFolder

TITLES = {"centroid": "Which cluster next?", "waypoint": "Where to next?", "mission": "What next for this mission?"}
TEAL, GRAY, BLUE, RED = "#0b6470", "#969fac", "#195ae6", "#d6342c"
CALM = ("ready", "surveying", "stopped")
"""States of the vehicle that need no attention."""
COLUMNS = ("t", "x", "y", "theta", "goal_x", "goal_y", "coverage", "v_cmd", "u", "clearance")
HULL_Z_M = 0.5
"""Height of the drawn robot above the seabed."""


class ReefSubject(Subject):
    """What is shown of one survey."""

    def __init__(self, run: RunFolder) -> None:
        config, size = run.config, run.world.get("size_m") or (20.0, 20.0)
        about = [f"{key} {config[key]}" for key in ("advisor", "variant", "seed") if key in config]
        self.head: dict[str, Any] = {
            "kind": "reef",
            "title": str(run.world.get("name") or config.get("world") or run.path.name),
            "about": ", ".join(about),
            "ground": {"size": [float(size[0]), float(size[1])], "origin": [0.0, 0.0], "grid": 1.0},
            "view": {"yaw": 0.0, "pitch": 1.05},
            "columns": COLUMNS,
            "solids": _rov(),
            "truth": [points.round(3).tolist() for _, points in outlines(run.world)],
            "tiles": [
                {"name": "coverage", "column": "coverage", "scale": 100, "unit": " %", "digits": 0},
                {"name": "speed", "column": "u", "scale": 1, "unit": " m/s", "digits": 2},
            ],
            "charts": [
                _chart("Coverage (%)", [("coverage", "coverage", TEAL, 100)], [0, 105]),
                _chart("Forward speed (m/s)", [("commanded", "v_cmd", GRAY, 1), ("driven", "u", BLUE, 1)]),
                _chart("Hull to nearest obstacle (m)", [("clearance", "clearance", RED, 1)]),
            ],
            "legend": [
                ["#bec1c5", "explored"],
                ["#000", "obstacle"],
                ["#26a64c", "oysters"],
                ["#ffd900", "way so far"],
                ["#ff8500", "cluster"],
                ["#be00aa", "goal"],
            ],
        }
        self._calls = self._again = self._hits = self._covered = self._clusters = 0
        self._judged = True
        self._cause = self._state = ""
        self._asked: Moment | None = None

    def row(self, row: Mapping[str, float]) -> list[float]:
        """Return a row; the robot is where it believes it is, as on its map."""
        believed = {name: row.get(f"est_{name}", math.nan) for name in ("x", "y", "theta")}
        if all(map(math.isfinite, believed.values())):
            row = {**row, **believed}
        return [row.get(name, math.nan) for name in COLUMNS]

    def _numbers(self) -> list[list[str]]:
        again = f" ({self._again} again)" if self._again else ""
        return [
            ["clusters", f"{self._covered} of {self._clusters}", ""],
            *([["collisions", str(self._hits), "bad" if self._hits else ""]] if self._judged else []),
            ["advisor calls", f"{self._calls}{again}", ""],
            *([["state", self._state, "" if self._state in CALM else "bad"]] if self._state else []),
        ]

    def _on_start(self, event: Record) -> Moment:
        self._clusters = int(event.get("clusters_total") or 0)
        self._judged = event.get("judged_by") != OWN_MAP
        return {"line": "the mission begins"}

    def _on_trigger(self, event: Record) -> None:
        if event.get("fired"):
            self._cause = str(event.get("cause", ""))

    def _on_question(self, event: Record) -> Moment:
        mode, attempt = str(event.get("mode", "")), int(event.get("attempt") or 0)
        self._calls += 1
        self._again += attempt > 0
        title, cause = TITLES.get(mode, mode), CAUSES.get(self._cause, self._cause)
        again = f", attempt {attempt + 1}" if attempt else ""
        pictures = [str(digest) for digest in event.get("pictures") or () if str(digest).isalnum()]
        asked = {"title": title, "detail": f"{mode} mode{again}", "cause": cause, "since": event["t"]}
        told: Moment = {"line": f"asked: {title}{again}", "asked": asked, "pictures": pictures}
        return {**told, **_dots(event)}

    def _on_verdict(self, event: Record) -> Moment:
        answer = event.get("answer")
        heard = Try(
            attempt=0,
            asked_at_s=0.0,
            answered_at_s=0.0,
            verdict=str(event.get("verdict", "")),
            answer=answer if isinstance(answer, dict) else {"answer": answer} if answer else {},
        )
        reason = str(event.get("reason") or "") or heard.why
        answered = {"verdict": heard.verdict, "said": heard.said, "reason": reason, "at": event["t"]}
        return {"line": f"{heard.verdict}: {heard.said}", "asked": None, "answered": answered}

    def _on_goal(self, event: Record) -> Moment | None:
        source = event.get("source")
        if source in ("advisor", "recording"):
            return _marks(event) or None
        told = {"fallback": "new goal, chosen by the rules", "tour": "new goal of its own tour", "home": "the way home"}
        return {"line": told.get(str(source), "first goal, straight ahead"), **_marks(event), **_dots(event)}

    def _on_instruction(self, event: Record) -> Moment:
        return {"line": f"instruction, by {event.get('by', '')}", "instruction": str(event.get("text", ""))}

    def _on_cluster_covered(self, event: Record) -> Moment:
        self._covered += 1
        return {"line": f"covered {event.get('name', 'a cluster')}"}

    def _on_collision(self, event: Record) -> Moment:
        self._hits += 1
        return {"line": "collision", "mark": "bad"}

    def _on_state(self, event: Record) -> Moment:
        self._state = str(event.get("state", ""))
        return {"line": f"{self._state}: {event.get('reason', '')}"}

    def _on_sensor(self, event: Record) -> Moment:
        return {"line": f"{event.get('input', 'sensor')} {event.get('refused') or 'is good again'}"}

    def _on_planner_failure(self, event: Record) -> Moment:
        return {"line": f"no way found: {event.get('reason', '')}"}

    def _on_held(self, event: Record) -> Moment:
        return {"line": f"answered: {event['answer']}" if event.get("answer") else "the goal is kept", **_marks(event)}

    def _on_fallback(self, event: Record) -> Moment:
        return {"line": f"the advisor failed ({event.get('failure', '')})", "mark": "bad"}

    def _on_monitor(self, _: Record) -> Moment:
        return {"line": "left the planned path, planned again"}

    def _on_end(self, event: Record) -> Moment:
        reason = str(event.get("reason", ""))
        return {"line": f"ended: {reason}", "asked": None, "ended": reason}


def _dots(event: Record) -> Moment:
    """Return the chain of clusters that an event tells, if it tells one."""
    dots = [
        [str(dot["index"]), float(dot["x"]), float(dot["y"]), bool(dot.get("visited"))]
        for dot in event.get("centroids") or ()
        if {"index", "x", "y"} <= set(dot)
    ]
    return {"dots": dots} if dots else {}


def _marks(event: Record) -> Moment:
    """Return what an event tells of what the advisor took things for."""
    said = said_by([event])
    return {"marks": [[one.name, one.x, one.y] for one in said]} if said else {}


def _chart(title: str, series: list[tuple[str, str, str, float]], bounds: list[float] | None = None) -> dict[str, Any]:
    made = [{"name": n, "column": column, "color": color, "scale": scale} for n, column, color, scale in series]
    return {"title": title, "series": made, "bounds": bounds}


def _rov() -> list[dict[str, Any]]:
    """Draw a BlueROV2 from boxes: blue floats on black side plates, a clear dome in front, thrusters; m, body FLU."""

    def part(shape: str, center: tuple[float, float, float], size: tuple[float, float, float], color: str) -> Moment:
        return {"body": "robot", "shape": shape, "center": center, "size": size, "color": color, "opacity": 1.0}

    made = [
        part("box", (0.0, 0.0, 0.0), (0.34, 0.12, 0.11), "#e1e4e8"),
        part("ball", (0.19, 0.0, 0.0), (0.11, 0.11, 0.11), "#96cdeb"),
    ]
    for side in (1.0, -1.0):
        made += [
            part("box", (0.0, 0.12 * side, 0.10), (0.44, 0.11, 0.09), "#1c6ebe"),
            part("box", (0.0, 0.18 * side, -0.02), (0.457, 0.015, 0.24), "#222428"),
            *(part("cylinder", (0.16 * end, 0.13 * side, -0.08), (0.09, 0.09, 0.07), "#787e86") for end in (1.0, -1.0)),
        ]
    return [{**one, "center": [*one["center"][:2], one["center"][2] + HULL_Z_M]} for one in made]

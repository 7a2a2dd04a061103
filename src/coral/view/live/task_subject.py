"""A contact task for the viewer: hand, objects and fixtures as simple solids, and what its events say."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import mujoco

from coral.contact.control.hand_model import HandCfg
from coral.contact.control.planning_model import build_model
from coral.contact.scene.geometry import quaternion_of
from coral.contact.scene.trial import Trial
from coral.view.contact.replay import trial_of_run
from coral.view.contact.thought import ASKED
from coral.view.live.stream import Moment, Subject
from coral.view.records import is_number
from coral.view.run import Record, RunFolder

POSE = ("x", "y", "z", "qw", "qx", "qy", "qz")
M_PER_N = 0.01
"""Length of the drawn force."""
RED, BLUE, GREEN = "#d6342c", "#195ae6", "#0a7d4f"


class TaskSubject(Subject):
    """What is shown of one episode.

    Raises:
        InputError: The folder has no task, or no seed.
    """

    def __init__(self, run: RunFolder) -> None:
        trial, config = trial_of_run(run), run.config
        self._columns: tuple[str, ...] = ("t", *POSE, "opening", "fx", "fy", "fz", "force")
        self._columns += tuple(f"{name}_{part}" for name in trial.objects for part in POSE)
        table = trial.task.table
        about = [f"{key} {config[key]}" for key in ("advisor", "variant", "seed") if key in config]
        force = {"name": "force", "column": "force", "color": RED, "scale": 1}
        self.head: dict[str, Any] = {
            "kind": "task",
            "title": trial.task.title or trial.task.name,
            "about": ", ".join(about),
            "ground": {
                "size": [float(table.size[0]), float(table.size[1])],
                "origin": [float(table.center[k] - table.size[k] / 2) for k in (0, 1)],
                "grid": 0.1,
            },
            "view": {"yaw": 0.7, "pitch": 0.55, "span": 0.75},
            "columns": self._columns,
            "solids": _solids(trial),
            "objects": list(trial.objects),
            "places": [[name, *map(float, place)] for name, place in trial.task.places.items()],
            "m_per_n": M_PER_N,
            "truth": [],
            "tiles": [{"name": "force", "column": "force", "scale": 1, "unit": " N", "digits": 1, "bad_above": 30}],
            "charts": [{"title": "Force on the hand (N)", "series": [force], "bounds": None}],
            "legend": [[BLUE, "path of the tool"], [RED, "force on the hand, 1 cm a newton"], [GREEN, "place"]],
        }
        self._stage, self._calls = "-", 0
        self._plan: Record = {}

    def row(self, row: Mapping[str, float]) -> list[float]:
        """Return a row, with the size of the force."""
        force = math.hypot(*(row.get(name, math.nan) for name in ("fx", "fy", "fz")))
        return [force if name == "force" else row.get(name, math.nan) for name in self._columns]

    def _numbers(self) -> list[list[str]]:
        cost, effective = self._plan.get("cost"), self._plan.get("ess")
        return [
            ["stage", self._stage, ""],
            ["cost of the plan", f"{cost:.2f}" if isinstance(cost, float) else "-", ""],
            ["effective samples", f"{effective:.1f}" if isinstance(effective, float) else "-", ""],
            ["advisor calls", str(self._calls), ""],
        ]

    def _on_start(self, event: Record) -> Moment:
        return {"line": f"the task: {event.get('instruction', '')}"}

    def _on_plan(self, event: Record) -> Moment:
        self._plan, terms = event, event.get("terms")
        if not isinstance(terms, dict):
            return {}
        known = {str(name): value for name, value in terms.items() if is_number(value)}
        return {"terms": {"stage": str(event.get("stage")), "values": known}}

    def _on_verdict(self, event: Record) -> Moment:
        self._calls += 1
        kind, verdict = str(event.get("kind", "")), str(event.get("verdict", ""))
        what, code, reason = ASKED.get(kind, kind), event.get("code"), str(event.get("reason") or "")
        answered = {"verdict": verdict, "said": what, "reason": reason, "at": event["t"]}
        return {"line": f"{verdict}: {what}{f' ({code})' if code else ''}", "answered": answered}

    def _on_strategy(self, event: Record) -> Moment:
        return {"line": f"follows “{event.get('name')}”"}

    def _on_stage(self, event: Record) -> Moment:
        self._stage = str(event.get("stage"))
        return {"line": f"stage “{self._stage}”", "mark": "stage"}

    def _on_stuck(self, event: Record) -> Moment:
        return {"line": f"stuck in “{event.get('stage')}”: {event.get('text')}", "mark": "bad"}

    def _on_correction(self, event: Record) -> Moment:
        return {"line": f"correction: {event.get('text', '')}"}

    def _on_fallback(self, event: Record) -> Moment:
        return {"line": f"the advisor did not decide on the {event.get('what', '')}", "mark": "bad"}

    def _on_weight(self, event: Record) -> Moment:
        return {"line": f"operator: {event.get('factor')} × “{event.get('term')}” in “{event.get('stage')}”"}

    def _on_track(self, event: Record) -> Moment:
        name = event.get("object")
        return {"line": f"{name} lost: {event.get('reason')}" if event.get("lost") else f"{name} found again"}

    def _on_contact(self, event: Record) -> Moment | None:
        pair = sorted({str(event.get("first")), str(event.get("second"))})
        return {"line": " touches ".join(pair)} if event.get("step", 1) and "table" not in pair else None

    def _on_end(self, event: Record) -> Moment:
        reason, detail = str(event.get("reason", "")), event.get("detail")
        return {"line": f"ended: {reason}{f' ({detail})' if detail else ''}", "ended": reason}


def _solids(trial: Trial) -> list[dict[str, Any]]:
    """Return the solids of a trial: sizes and shapes, in the frames of their bodies; fixed ones in the world's."""
    model = build_model(trial, HandCfg(), 0.01)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    moving = {*trial.objects, "hand", "left", "right"}
    made = []
    for geom in range(model.ngeom):
        name = model.geom(geom).name
        body = model.body(int(model.geom_bodyid[geom])).name
        size = [float(value) for value in model.geom_size[geom]]
        shape, edges = _shape(model, geom, size)
        if name == "table" or not shape:
            continue
        if body in moving:
            position, turn = model.geom_pos[geom], model.geom_quat[geom]
        else:
            position, turn, body = data.geom_xpos[geom], quaternion_of(data.geom_xmat[geom].reshape(3, 3)), ""
        # The wrist is no more than room that the real hand needs, and a wall may stand before what happens.
        opacity = 0.25 if name == "wrist" else 0.5 if not body else 1.0
        red, green, blue = (round(255 * float(value)) for value in model.geom_rgba[geom, :3])
        made.append(
            {
                "body": body,
                "shape": shape,
                "size": edges,
                "center": [round(float(v), 5) for v in position],
                "turn": [round(float(v), 6) for v in turn],
                "color": f"#{red:02x}{green:02x}{blue:02x}",
                "opacity": opacity,
            }
        )
    return made


def _shape(model: mujoco.MjModel, geom: int, size: list[float]) -> tuple[str, list[float]]:
    """Return how a geom is drawn, and its edges (m); "" for what is not drawn."""
    kind = int(model.geom_type[geom])
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        return "box", [2 * edge for edge in size]
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return "ball", [2 * size[0]] * 3
    if kind in (mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_CAPSULE):
        ends = 2 * size[0] if kind == mujoco.mjtGeom.mjGEOM_CAPSULE else 0.0
        return "cylinder", [2 * size[0], 2 * size[0], 2 * size[1] + ends]
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        return "box", [2 * float(v) for v in model.geom_aabb[geom, 3:]]
    return "", []

"""The scene of a contact task for the live page: hand, objects, fixtures and table as simple solids."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.contact.control.hand_model import HandCfg
from coral.contact.control.planning_model import build_model
from coral.contact.control.rehearsed_paths import RehearsedPaths
from coral.contact.scene.geometry import multiply, rotate
from coral.contact.scene.observation import BodyState
from coral.contact.scene.trial import Trial
from coral.view.live.state import Ground, Line, LiveBody, LivePart, Marker
from coral.view.live.strokes import joined
from coral.view.pictures import RGB

Array = NDArray[np.float64]
TABLE: RGB = (226, 219, 207)
PLAN: RGB = (11, 100, 112)
TRIED: RGB = (168, 182, 194)
CARRIED: RGB = (255, 133, 0)
TRAIL: RGB = (25, 90, 230)
FORCE: RGB = (214, 52, 44)
GOAL: RGB = (10, 125, 79)
LEGEND: tuple[tuple[RGB, str], ...] = (
    (TRAIL, "way of the tool"),
    (FORCE, "force on the hand, 1 cm a newton"),
    (GOAL, "place"),
)
PLANNED: tuple[tuple[RGB, str], ...] = (
    (PLAN, "the best rehearsal"),
    (TRIED, "some of the others"),
    (CARRIED, "the objects in the best"),
)
VIEW = ((0.6, -0.7, 0.55), (0.0, 0.0, 0.08))
"""A corner of the table that neither arm nor hand stands in front of."""
M_PER_N = 0.01
CELL_M = 0.05


@dataclass(frozen=True)
class _Solid:
    """One geom of the model, in the frame of its body."""

    name: str
    body: str
    position: Array
    quaternion: Array
    parts: tuple[LivePart, ...]


class TaskScene:
    """The solids of one trial.

    Args:
        trial: The trial. Only sizes, shapes and fixed things are read: where objects are comes with each moment.
    """

    def __init__(self, trial: Trial) -> None:
        model = build_model(trial, HandCfg(), 0.01)
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        self._fixed = {
            model.body(k).name: BodyState(data.xpos[k].copy(), data.xquat[k].copy()) for k in range(model.nbody)
        }
        solids = (_solid(model, k) for k in range(model.ngeom) if model.geom(k).name != "table")
        self._solids = tuple(solid for solid in solids if solid is not None)
        table = trial.task.table
        width, depth = (max(1, round(edge / CELL_M)) for edge in table.size[:2])
        self.ground = Ground(
            cells=np.zeros((depth, width), np.uint8),
            palette=np.array([TABLE], np.uint8),
            cell_m=CELL_M,
            grid_m=0.1,
            origin=(table.center[0] - table.size[0] / 2, table.center[1] - table.size[1] / 2),
        )
        self.markers = tuple(
            Marker(label=name, position=(place[0], place[1], place[2]), color=GOAL, radius_m=0.008)
            for name, place in trial.task.places.items()
        )

    def bodies(self, tool: BodyState, opening_m: float, objects: Mapping[str, BodyState]) -> tuple[LiveBody, ...]:
        """Return the solids at one moment.

        Args:
            tool: Pose of the tool.
            opening_m: Opening of the fingers.
            objects: Poses of the objects.
        """
        places = {**self._fixed, **objects, "hand": tool}
        for side, sign in (("left", 0.5), ("right", -0.5)):
            aside = rotate(tool.quaternion, np.array([0.0, sign * opening_m, 0.0]))
            places[side] = BodyState(tool.position + aside, tool.quaternion)
        made = []
        for solid in self._solids:
            base = places[solid.body]
            x, y, z = base.position + rotate(base.quaternion, solid.position)
            w, i, j, k = multiply(base.quaternion, solid.quaternion)
            made.append(
                LiveBody(
                    name=solid.name,
                    parts=solid.parts,
                    position=(float(x), float(y), float(z)),
                    wxyz=(float(w), float(i), float(j), float(k)),
                )
            )
        return tuple(made)


def lines(trail: Array, tool: Array, force: Array, paths: RehearsedPaths | None = None) -> tuple[Line, ...]:
    """Return the lines of one moment.

    Args:
        trail: Where the tool has been, Shape=(N, 3) m.
        tool: Its position, Shape=(3,) m.
        force: Force on the hand, Shape=(3,) N.
        paths: Rehearsals of the present plan; None without a plan.
    """
    ahead = () if paths is None else tuple(paths.objects.values())
    best = () if paths is None else (paths.best,)
    some = () if paths is None else tuple(paths.some)
    return (
        Line(name="trail", segments=joined((trail,)), color=TRAIL, width_px=2.0),
        Line(name="tried", segments=joined(some), color=TRIED, width_px=1.0, layer="rollouts"),
        Line(name="carried", segments=joined(ahead), color=CARRIED, width_px=3.0),
        Line(name="plan", segments=joined(best), color=PLAN, width_px=4.0),
        Line(name="force", segments=joined((np.stack([tool, tool + M_PER_N * force]),)), color=FORCE, width_px=4.0),
    )


def _solid(model: mujoco.MjModel, geom: int) -> _Solid | None:
    color = tuple(round(255 * float(value)) for value in model.geom_rgba[geom, :3])
    look: RGB = (color[0], color[1], color[2])
    kind, size = int(model.geom_type[geom]), [float(value) for value in model.geom_size[geom]]
    parts: tuple[LivePart, ...]
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        parts = (_part("box", (2 * size[0], 2 * size[1], 2 * size[2]), look),)
    elif kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        parts = (_part("ball", (2 * size[0],) * 3, look),)
    elif kind in (mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_CAPSULE):
        parts = (_part("cylinder", (2 * size[0], 2 * size[0], 2 * size[1]), look),)
        if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
            ends = (-size[1], size[1])
            parts += tuple(_part("ball", (2 * size[0],) * 3, look, (0.0, 0.0, end)) for end in ends)
    elif kind == mujoco.mjtGeom.mjGEOM_MESH:
        low, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
        center, edges = [float(v) for v in low], [2 * float(v) for v in half]
        parts = (_part("box", (edges[0], edges[1], edges[2]), look, (center[0], center[1], center[2])),)
    else:
        return None
    body = model.body(int(model.geom_bodyid[geom])).name
    # The wrist is no more than room that the real hand needs, and a wall may stand before what happens.
    opacity = 0.25 if model.geom(geom).name == "wrist" else 0.5 if model.geom_bodyid[geom] == 0 else 1.0
    parts = tuple(replace(part, opacity=opacity) for part in parts)
    return _Solid(f"{body}-{geom}", body, model.geom_pos[geom].copy(), model.geom_quat[geom].copy(), parts)


def _part(
    shape: str, size: tuple[float, ...], color: RGB, center: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> LivePart:
    return LivePart(shape=shape, center=center, size=(size[0], size[1], size[2]), color=color)  # type: ignore[arg-type]

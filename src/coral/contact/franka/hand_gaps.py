"""What an arm's hand may run into: gaps between the hand, what it touches, and everything around it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.contact.control.hand_model import HandCfg, add_hand
from coral.contact.scene.geometry import rotation_of
from coral.contact.scene.mujoco_scene import add_scene, geom_gap
from coral.contact.scene.observation import Array, BodyState
from coral.contact.scene.trial import Trial

Geoms = NDArray[np.int64]
TOUCHING_M = 0.004
"""A gap that the errors of tracked poses explain."""
SHRUNK_M = 0.004
"""The hand is modelled smaller by so much on each side: between things that touch a gap has no direction."""
_FINGERS = ("left", "right")
_NO_DIRECTION_M = 1e-9


@dataclass(frozen=True)
class Gap:
    """A gap between the hand, or something that it moves, and something else."""

    direction: Array
    """Shape=(3,) unit vector across the gap, away from the hand."""
    distance_m: float
    """Width of the gap; at least 0."""
    lever_m: Array
    """Shape=(3,), from the tool to the gap's near side."""


class HandGaps:
    """Finds the gaps from the poses of hand and objects, and from the task's shapes.

    Only the hand is considered, not the other links of the arm, and of the trial only shapes and fixtures.
    """

    def __init__(self, trial: Trial) -> None:
        spec = mujoco.MjSpec()
        add_hand(spec, HandCfg())
        add_scene(spec, trial)
        self._model = model = spec.compile()
        self._data = data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        owner = np.array([model.body(int(body)).name for body in model.geom_bodyid])
        solid = model.geom_contype != 0
        self._parts = {part: np.flatnonzero((owner == part) & solid) for part in ("hand", *_FINGERS)}
        self._hand = np.concatenate(list(self._parts.values()))
        self._objects = {name: np.flatnonzero((owner == name) & solid) for name in trial.objects}
        self._fixed = np.flatnonzero((model.geom_bodyid == 0) & solid)
        self._place = model.geom_pos.copy(), np.array([rotation_of(quat) for quat in model.geom_quat])
        for geom in self._hand:
            self._shrink(int(geom))
        self._reach = model.geom_rbound.copy()
        self._reach[model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE] = np.inf

    def gaps(
        self, tool: BodyState, opening_m: float, objects: Mapping[str, BodyState], within_m: float
    ) -> Sequence[Gap]:
        """Return the gaps narrower than `within_m`.

        Those of the hand, and those of every object that it touches to the table, the fixtures and the other objects.
        What both fingers touch moves with them and is no obstacle to them. An object that is missing is not considered.
        """
        self._put(self._parts["hand"], tool)
        for part, side in zip(_FINGERS, (0.5, -0.5), strict=True):
            self._put(self._parts[part], tool, np.array([0.0, side * opening_m, 0.0]))
        for name, body in objects.items():
            self._put(self._objects[name], body)
        found = [self._between(self._hand, self._fixed, tool, within_m, SHRUNK_M)]
        touched = []
        for name in objects:
            gaps = {
                part: self._between(own, self._objects[name], tool, within_m, SHRUNK_M)
                for part, own in self._parts.items()
            }
            touching = {part for part, those in gaps.items() if any(gap.distance_m < TOUCHING_M for gap in those)}
            if touching:
                touched.append(name)
            held = touching.issuperset(_FINGERS)
            found += [those for part, those in gaps.items() if not (held and part in _FINGERS)]
        for name in touched:
            others = [self._fixed, *(self._objects[other] for other in objects if other not in touched)]
            found.append(self._between(self._objects[name], np.concatenate(others), tool, within_m, 0.0))
        return [gap for those in found for gap in those]

    def _put(self, geoms: Geoms, body: BodyState, offset: Array | None = None) -> None:
        turn = rotation_of(body.quaternion)
        places, turns = self._place
        local = places[geoms] if offset is None else places[geoms] + offset
        self._data.geom_xpos[geoms] = local @ turn.T + body.position
        self._data.geom_xmat[geoms] = (turn @ turns[geoms]).reshape(-1, 9)

    def _between(self, near: Geoms, far: Geoms, tool: BodyState, within_m: float, shrunk_m: float) -> list[Gap]:
        """Return the gaps between two sets of geoms, one for each pair."""
        data, found, wide = self._data, [], within_m + shrunk_m
        apart = np.linalg.norm(data.geom_xpos[near][:, None] - data.geom_xpos[far][None], axis=-1)
        apart -= self._reach[near][:, None] + self._reach[far][None]
        for i, k in np.argwhere(apart < wide):
            distance, start, end = geom_gap(self._model, data, int(near[i]), int(far[k]), wide)
            length = float(np.linalg.norm(end - start))
            if distance < wide and length > _NO_DIRECTION_M:
                direction = (end - start) / (length if distance > 0.0 else -length)
                found.append(Gap(direction, max(0.0, distance - shrunk_m), start - tool.position))
        return found

    def _shrink(self, geom: int) -> None:
        model = self._model
        sizes = 3 if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_BOX else 1
        model.geom_size[geom, :sizes] = np.maximum(model.geom_size[geom, :sizes] - SHRUNK_M, 1e-3)

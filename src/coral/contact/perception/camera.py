"""A simulated RGB-D camera that casts rays into a MuJoCo scene: depth and object of every pixel. No OpenGL."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated

import mujoco
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from coral.config import Positive
from coral.contact.perception.depth_noise import DepthNoiseCfg
from coral.contact.perception.normal_kernels import normals
from coral.contact.perception.raycast_kernels import draw_object, render
from coral.contact.perception.solids import Solids, from_mujoco
from coral.contact.scene.observation import Array
from coral.contact.scene.trial import Trial


@dataclass(frozen=True, kw_only=True)
class RgbdCameraCfg:
    """Pinhole camera with square pixels; integer (u, v) are pixel centres; x right, y down, z forward."""

    width: Annotated[int, Field(ge=8, le=4096)] = 320
    height: Annotated[int, Field(ge=8, le=4096)] = 240
    """Size in pixels. The paper gives none; at 0.9 m a pixel is 3 mm wide, and tracking takes a third of its 36 ms."""
    vfov_deg: Annotated[float, Field(gt=0, lt=180)] = 45.0
    """Angle between the outer edges of the first and last row; similar to depth cameras used above tables."""
    near_m: Positive = 0.1
    far_m: Positive = 5.0
    """Only surfaces between these depths along the optical axis are visible."""

    @property
    def lens(self) -> Array:
        """Compute the intrinsics, Shape=(4,): fx, fy, cx, cy in pixels."""
        focal = 0.5 * self.height / math.tan(math.radians(self.vfov_deg) / 2)
        return np.array([focal, focal, (self.width - 1) / 2, (self.height - 1) / 2])


@dataclass(frozen=True)
class RgbdFrame:
    """One picture."""

    depth: NDArray[np.float32]
    """Depth along the optical axis, Shape=(H, W) m; 0 where nothing was measured."""
    instance: NDArray[np.uint8]
    """Segmentation, Shape=(H, W): 1 + index into `names`; 0 for things without a name."""
    names: tuple[str, ...]
    """Names of things."""
    lens: Array
    """Intrinsics, Shape=(4,): fx, fy, cx, cy in pixels."""
    T_world_camera: Array
    """Shape=(4, 4), camera optical frame to world."""
    time_s: float = 0.0
    """Time of the picture."""
    rgb: NDArray[np.uint8] | None = None
    """Colours, Shape=(H, W, 3); None if none were requested."""

    def mask(self, name: str) -> NDArray[np.bool_]:
        """Return the mask of `name`, Shape=(H, W).

        Raises:
            KeyError: The camera does not know this name.
        """
        if name not in self.names:
            raise KeyError(name)
        return np.asarray(self.instance == 1 + self.names.index(name))

    @property
    def K(self) -> Array:
        """Return the camera matrix, Shape=(3, 3)."""
        fx, fy, cx, cy = self.lens
        return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


def look_at(eye: Iterable[float], target: Iterable[float]) -> Array:
    """Compute T_world_camera, Shape=(4, 4), of an upright camera; the target (m) is not straight above or below it."""
    position = np.array([*eye], float)
    forward = np.array([*target], float) - position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = right, np.cross(forward, right), forward, position
    return pose


class RayCamera:
    """Takes pictures of one MuJoCo model, with one exact ray per pixel.

    `instances` names the things by geom id; other geoms are drawn without a name, those of other `groups` (MuJoCo draws
    0 to 2 by default) and the `hidden` ones not at all. Colours are shaded by the rays.

    Raises:
        InputError: Rays cannot draw a geom of the scene.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        cfg: RgbdCameraCfg,
        T_world_camera: Array,
        instances: Mapping[int, str],
        *,
        groups: Iterable[int] = (0, 1, 2),
        noise: DepthNoiseCfg | None = None,
        colours: bool = False,
        hidden: Iterable[int] = (),
    ) -> None:
        visible = np.isin(model.geom_group, list(groups)) & (model.geom_rgba[:, 3] > 0.0)
        visible[[*hidden]] = False
        self._geoms = np.flatnonzero(visible).astype(np.int64)
        self._solids = from_mujoco(model, self._geoms)
        self._rgb = model.geom_rgba[self._geoms, :3].astype(float)
        for row, i in enumerate(self._geoms):
            if model.geom_matid[i] >= 0:
                self._rgb[row] = model.mat_rgba[model.geom_matid[i], :3]
        self.names = tuple(dict.fromkeys(instances.values()))
        known = {i: 1 + self.names.index(name) for i, name in instances.items()}
        # One more entry than geoms, for pixels (-1) without a hit.
        self._instance = np.array([*(known.get(int(i), 0) for i in self._geoms), 0], np.uint8)
        self.cfg, self.T_world_camera, self.noise = cfg, T_world_camera, noise
        self.colours = colours

    def take(self, data: mujoco.MjData, rng: np.random.Generator | None = None) -> RgbdFrame:
        """Take a picture of the present state; MuJoCo's kinematics must be up to date. With noise, `rng` is needed."""
        cfg, lens = self.cfg, self.cfg.lens
        turn, eye = np.ascontiguousarray(self.T_world_camera[:3, :3]), self.T_world_camera[:3, 3].copy()
        solids = self._solids._replace(
            center=data.geom_xpos[self._geoms], rotation=data.geom_xmat[self._geoms].reshape(-1, 3, 3)
        )
        picture = render(turn, eye, lens, cfg.near_m, cfg.far_m, solids, cfg.height, cfg.width)
        depth, solid, _ = picture
        instance = self._instance[solid]
        rgb = None
        if self.colours or self.noise is not None:
            normal = normals(turn, eye, lens, solids, picture)
            if self.colours:
                rgb = shade(normal, solid, self._rgb, lens)
            if self.noise is not None:
                if rng is None:
                    raise ValueError("a camera with noise needs a random generator")
                depth, instance = self.noise.apply(depth, normal, instance, lens, rng)
        measured = np.where(np.isfinite(depth), depth, 0.0).astype(np.float32)
        return RgbdFrame(measured, instance, self.names, lens, self.T_world_camera.copy(), float(data.time), rgb)


def draw_depth(solids: Solids, T_camera_object: Array, frame: RgbdFrame) -> Array:
    """Draw an object, in its own frame, alone, as a frame's camera would: Shape=(H, W) m, inf where it is not."""
    height, width = frame.depth.shape
    return np.asarray(draw_object(T_camera_object, solids, frame.lens, height, width)[0][0])


def instance_names(model: mujoco.MjModel, trial: Trial) -> dict[int, str]:
    """Map geoms to the movable object that they belong to; every other moving geom is the robot's."""
    bodies = {int(model.body(name).id): name for name in trial.objects}
    robot = {i: "robot" for i, b in enumerate(model.geom_bodyid) if int(b) not in bodies and int(model.body_weldid[b])}
    return robot | {i: bodies[int(b)] for i, b in enumerate(model.geom_bodyid) if int(b) in bodies}


def covered_geoms(model: mujoco.MjModel, apart: Iterable[str] = ()) -> list[int]:
    """List the collision shapes (group 0) of bodies that have visual ones (group 1); not those of some bodies."""
    plain, visual = (np.flatnonzero(model.geom_group == group) for group in (0, 1))
    bodies = {*model.geom_bodyid[visual].tolist()} - {0, *(int(model.body(name).id) for name in apart)}
    return [int(geom) for geom in plain if int(model.geom_bodyid[geom]) in bodies]


def hidden_geoms(model: mujoco.MjModel, trial: Trial) -> list[int]:
    """List the geoms that pictures for people leave out: collision shapes over visual ones, and the room."""
    task = trial.task
    ours = {"table", *(fixture.name for fixture in task.fixtures), *(f"mark/{mark.place}" for mark in task.marks)}
    room = [int(k) for k in np.flatnonzero(model.geom_bodyid == 0) if model.geom(int(k)).name not in ours]
    return [*room, *covered_geoms(model, trial.objects)]


_AMBIENT, _HEADLIGHT, _LAMP = 0.3, 0.4, 0.3
"""Shares of the light; their sum is 1, so that nothing is overexposed."""
_SKY = np.array([191, 209, 230], np.uint8)


def shade(normal: Array, solid: NDArray[np.int64], colour: Array, lens: Array) -> NDArray[np.uint8]:
    """Shade a picture by Lambert's law, with a headlight and a lamp above; return RGB, Shape=(H, W, 3).

    The unit normals, Shape=(H, W, 3), are in the camera frame, 0 without a surface; `solid` is the index into `colour`,
    Shape=(N, 3), from 0 to 1, -1 without a surface; the lens is fx, fy, cx, cy in pixels.
    """
    height, width = solid.shape
    rows, columns = np.nonzero(solid >= 0)
    p, q = (columns - lens[2]) / lens[0], (rows - lens[3]) / lens[1]
    n = normal[rows, columns]
    headlight = -(n[:, 0] * p + n[:, 1] * q + n[:, 2]) / np.sqrt(1.0 + p * p + q * q)
    light = (255.0 * (_AMBIENT + _HEADLIGHT * headlight.clip(0.0) + _LAMP * (-n[:, 1]).clip(0.0))).astype(np.float32)
    picture = np.broadcast_to(_SKY, (height, width, 3)).copy()
    picture[rows, columns] = (colour.astype(np.float32)[solid[rows, columns]] * light[:, None] + 0.5).astype(np.uint8)
    return picture

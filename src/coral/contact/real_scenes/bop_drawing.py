"""Depth and masks for a recorded scene that has none, drawn from the true poses of its objects."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.depth_noise import DepthNoise
from coral.contact.perception.normal_kernels import normals
from coral.contact.perception.ray_solids import from_triangles
from coral.contact.perception.raycast_kernels import render
from coral.contact.perception.solids import Solids
from coral.contact.real_scenes.bop_scene import BopScene, names_of

Array = NDArray[np.float64]
NEAR_M, FAR_M = 0.1, 5.0


class DrawnDepth:
    """Draws what a depth camera would measure of a scene's objects: poses, clutter and occlusion are the recorded ones.

    Nothing is measured beside the objects, since nothing else has a model.

    Args:
        scene: The scene.
        noise: Noise of depth and masks; None for none.
    """

    def __init__(self, scene: BopScene, noise: DepthNoise | None) -> None:
        self._scene, self._noise = scene, noise
        self._surfaces = {number: scene.triangles(number) for number in scene.objects}

    def read_frame(self, picture: int) -> RgbdFrame:
        """Draw a picture; the k-th object in it is named `str(k)`."""
        scene = self._scene
        camera, placed, shape = scene.cameras[picture], scene.placed[picture], scene.size(picture)
        solids = _joined([from_triangles(self._surfaces[one.number]) for one in placed])._replace(
            center=np.array([one.T_camera_object[:3, 3] for one in placed]),
            rotation=np.array([one.T_camera_object[:3, :3] for one in placed]),
        )
        depth, solid, face = np.empty(shape), np.empty(shape, np.int64), np.empty(shape, np.int64)
        turn, eye = np.eye(3), np.zeros(3)
        render(turn, eye, camera.lens, NEAR_M, FAR_M, solids, depth, solid, face)
        instance = (solid + 1).astype(np.uint8)
        if self._noise is not None:
            normal = np.empty((*shape, 3))
            normals(turn, eye, camera.lens, solids, depth, solid, face, normal)
            rng = np.random.default_rng([picture, 7])  # the same noise in every measurement
            depth, instance = self._noise.apply(depth, normal, instance, camera.lens, rng)
        measured = np.where(np.isfinite(depth), depth, 0.0).astype(np.float32)
        return RgbdFrame(measured, instance, names_of(len(placed)), camera.lens, camera.T_world_camera)


def _joined(each: list[Solids]) -> Solids:
    """Join meshes into one set of solids."""
    count = np.concatenate([one.triangle_count for one in each])
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    return Solids(*(np.concatenate(field) for field in zip(*each, strict=True)))._replace(first_triangle=first)

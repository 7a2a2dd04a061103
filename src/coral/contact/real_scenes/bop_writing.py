"""Writes the format of BOP (Hodan et al., 2018): a simulated motion as a recorded scene, and estimated poses."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.symmetry import Symmetry
from coral.contact.real_scenes.bop_records import MM, BopFiles
from coral.contact.real_scenes.bop_scene import BopScene
from coral.contact.real_scenes.recorded_accuracy import RecordedPose
from coral.contact.scene.rigid_transform import inverse_transform
from coral.errors import InputError
from coral.file_writer import write_whole

Array = NDArray[np.float64]
DEPTH_SCALE_MM = 0.1
"""A unit of depth: 16 bits reach 6.5 m."""


class BopWriter:
    """Writes pictures with their true poses, and the models of the objects.

    Args:
        folder: The folder of the scene, new or empty.
        models: The objects; the first one has the number 1.

    Raises:
        InputError: The folder is not empty.
    """

    def __init__(self, folder: Path, models: Mapping[str, ObjectModel]) -> None:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise InputError(str(folder), "", "a folder that is not empty", "a new or empty folder")
        self._folder = folder
        self._numbers = {name: 1 + k for k, name in enumerate(models)}
        for name, number in self._numbers.items():
            write_ply(folder / BopFiles.MODELS / f"obj_{number:06d}.ply", models[name].triangles)
        infos = {str(self._numbers[name]): _info(one) for name, one in models.items()}
        self._write(f"{BopFiles.MODELS}/{BopFiles.INFO}", infos)
        self._cameras: dict[str, Any] = {}
        self._truth: dict[str, Any] = {}

    def add(self, frame: RgbdFrame, truth: Mapping[str, Array]) -> None:
        """Write a picture.

        Args:
            frame: The picture, in which objects have the names of the models.
            truth: T_world_object, Shape=(4, 4), of each object.
        """
        index = len(self._truth)
        camera = inverse_transform(frame.T_world_camera)
        self._cameras[str(index)] = {
            "cam_K": frame.K.ravel().tolist(),
            "depth_scale": DEPTH_SCALE_MM,
            "time_s": frame.time_s,  # BOP has no times; its readers ignore this
            **_written(camera, "w2c"),
        }
        self._truth[str(index)] = [
            {**_written(camera @ truth[name], "m2c"), "obj_id": number} for name, number in self._numbers.items()
        ]
        depth = np.clip(np.rint(frame.depth / (MM * DEPTH_SCALE_MM)), 0, 65535).astype(np.uint16)
        self._picture(f"{BopFiles.DEPTH}/{index:06d}.png", depth)
        for k, name in enumerate(self._numbers):
            mask = frame.mask(name).astype(np.uint8) * 255
            self._picture(f"{BopFiles.MASKS}/{index:06d}_{k:06d}.png", mask)
        if frame.rgb is not None:
            self._picture(f"{BopFiles.COLOURS}/{index:06d}.png", frame.rgb[..., ::-1])

    def close(self) -> None:
        """Write the poses."""
        self._write(BopFiles.CAMERAS, self._cameras)
        self._write(BopFiles.TRUTH, self._truth)

    def _picture(self, name: str, image: NDArray[Any]) -> None:
        write_whole(self._folder / name, cv2.imencode(".png", image)[1].tobytes())

    def _write(self, name: str, content: Mapping[str, Any]) -> None:
        write_whole(self._folder / name, json.dumps(content, indent=1) + "\n")


def write_ply(path: Path, triangles: Array) -> None:
    """Write a surface, Shape=(M, 3, 3) m, as a text PLY file in millimetres."""
    corners, faces = np.unique(np.round(triangles.reshape(-1, 3) / MM, 6), axis=0, return_inverse=True)
    lines = [
        "ply", "format ascii 1.0", f"element vertex {len(corners)}", "property float x", "property float y",
        "property float z", f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header",
        *(" ".join(f"{value:.6g}" for value in corner) for corner in corners),
        *(f"3 {a} {b} {c}" for a, b, c in faces.reshape(-1, 3)),
    ]  # fmt: skip
    write_whole(path, "\n".join(lines) + "\n")


def _written(pose: Array, kind: str) -> dict[str, list[float]]:
    return {f"cam_R_{kind}": pose[:3, :3].ravel().tolist(), f"cam_t_{kind}": (pose[:3, 3] / MM).tolist()}


def _info(model: ObjectModel) -> dict[str, Any]:
    low, high = (bound(model.triangles.reshape(-1, 3), axis=0) / MM for bound in (np.min, np.max))
    return {
        "diameter": model.diameter / MM,
        **{f"min_{axis}": value for axis, value in zip("xyz", low.tolist(), strict=True)},
        **{f"size_{axis}": value for axis, value in zip("xyz", (high - low).tolist(), strict=True)},
        **_symmetry(model.symmetry),
    }


def _symmetry(symmetry: Symmetry) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if len(symmetry.rotations) > 1:
        turns = Symmetry(symmetry.rotations, None, symmetry.center).members()[1:]
        turns[:, :3, 3] /= MM
        found["symmetries_discrete"] = [turn.ravel().tolist() for turn in turns]
    if symmetry.axis is not None:
        offset = (symmetry.center / MM).tolist()
        found["symmetries_continuous"] = [{"axis": symmetry.axis.tolist(), "offset": offset}]
    return found


def write_bop_results(path: Path, scene: BopScene, poses: Iterable[RecordedPose]) -> None:
    """Write the estimates as a table of results in BOP's format, which its own tools evaluate.

    Columns: scene_id, im_id, obj_id, score, R (row by row), t (mm), time (s). Poses that were followed are left out.
    """
    name = scene.folder.resolve().name
    lines = ["scene_id,im_id,obj_id,score,R,t,time"]
    for one in poses:
        if one.followed or one.estimate.lost:
            continue
        camera = inverse_transform(scene.cameras[one.picture].T_world_camera)
        pose = camera @ one.estimate.T_world_object
        turn, place = (" ".join(f"{value:.6f}" for value in part) for part in (pose[:3, :3].ravel(), pose[:3, 3] / MM))
        score, scene_id = one.estimate.confidence, int(name) if name.isdecimal() else 0
        lines.append(f"{scene_id},{one.picture},{one.number},{score:.4f},{turn},{place},{one.seconds:.4f}")
    write_whole(path, "\n".join(lines) + "\n")

"""Writes pictures in the format of BOP (Hodan et al., 2018), which a recorded camera plays."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.bop_records import MM, BopFiles
from coral.contact.real_scenes.tracking_accuracy import AccuracyCfg, take_motion
from coral.contact.scene.rigid_transform import inverse_transform
from coral.contact.scene.trial import Trial
from coral.errors import InputError
from coral.file_writer import write_whole

DEPTH_SCALE_MM = 0.1
"""A unit of depth: 16 bits reach 6.5 m."""


class BopWriter:
    """Writes pictures with their cameras.

    Args:
        folder: The folder of the recording, new or empty.

    Raises:
        InputError: The folder is not empty.
    """

    def __init__(self, folder: Path) -> None:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise InputError(str(folder), "", "a folder that is not empty", "a new or empty folder")
        self._folder = folder
        self._cameras: dict[str, Any] = {}

    def add(self, frame: RgbdFrame) -> None:
        """Write a picture."""
        index = len(self._cameras)
        camera = inverse_transform(frame.T_world_camera)
        self._cameras[str(index)] = {
            "cam_K": frame.K.ravel().tolist(),
            "depth_scale": DEPTH_SCALE_MM,
            "time_s": frame.time_s,  # BOP has no times; its readers ignore this
            "cam_R_w2c": camera[:3, :3].ravel().tolist(),
            "cam_t_w2c": (camera[:3, 3] / MM).tolist(),
        }
        depth = np.clip(np.rint(frame.depth / (MM * DEPTH_SCALE_MM)), 0, 65535).astype(np.uint16)
        self._picture(f"{BopFiles.DEPTH}/{index:06d}.png", depth)
        if frame.rgb is not None:
            self._picture(f"{BopFiles.COLOURS}/{index:06d}.png", frame.rgb[..., ::-1])

    def close(self) -> None:
        """Write the cameras."""
        write_whole(self._folder / BopFiles.CAMERAS, json.dumps(self._cameras, indent=1) + "\n")

    def _picture(self, name: str, image: NDArray[Any]) -> None:
        write_whole(self._folder / name, cv2.imencode(".png", image)[1].tobytes())


def record_motion(trial: Trial, cfg: AccuracyCfg, folder: Path) -> int:
    """Write a task's motion as a recording with colours; return the number of its pictures.

    Raises:
        InputError: The folder is not empty.
    """
    writer = BopWriter(folder)
    _, frames, _ = take_motion(trial, replace(cfg, colours="shaded"))
    for frame in frames:
        writer.add(frame)
    writer.close()
    return len(frames)

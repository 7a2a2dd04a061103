"""Recordings in the format of BOP, small ones: two pictures of a box and a can, 64 x 48 pixels."""

import dataclasses
import json

import cv2
import numpy as np

from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.real_scenes.bop_records import MM, BopFiles
from coral.contact.real_scenes.posed_scene import PosedScene, scene_at_start
from coral.contact.scene.rigid_transform import inverse_transform

CFG = TrackedCfg(camera=RgbdCameraCfg(width=64, height=48), noise=False)
DEPTH_SCALE_MM = 0.1


def write_scene(folder, trial, pictures=2):
    """Write pictures of the trial's scene as it begins; return them."""
    scene, start = PosedScene(trial, CFG), scene_at_start(trial)
    states = [dataclasses.replace(start, time_s=0.1 * k) for k in range(pictures)]
    frames = [scene.take(state, np.random.default_rng(0)) for state in states]
    write_frames(folder, frames)
    return frames


def write_frames(folder, frames):
    """Write pictures with their cameras."""
    for kind in (BopFiles.DEPTH, BopFiles.COLOURS):
        (folder / kind).mkdir(parents=True)
    cameras = {}
    for index, frame in enumerate(frames):
        camera = inverse_transform(frame.T_world_camera)
        cameras[str(index)] = {
            "cam_K": frame.K.ravel().tolist(),
            "depth_scale": DEPTH_SCALE_MM,
            "time_s": frame.time_s,
            "cam_R_w2c": camera[:3, :3].ravel().tolist(),
            "cam_t_w2c": (camera[:3, 3] / MM).tolist(),
        }
        depth = np.rint(frame.depth / (MM * DEPTH_SCALE_MM)).astype(np.uint16)
        cv2.imwrite(str(folder / BopFiles.DEPTH / f"{index:06d}.png"), depth)
        cv2.imwrite(str(folder / BopFiles.COLOURS / f"{index:06d}.png"), frame.rgb[..., ::-1])
    (folder / BopFiles.CAMERAS).write_text(json.dumps(cameras))

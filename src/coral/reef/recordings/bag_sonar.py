"""A bag's echoes as range images on the map, and as points of known depth in the camera's pictures."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.map.sonar_3d15 import SonarCfg, sonar_attitude
from coral.reef.recordings.frame_tree import BodyTrack, frame_name
from coral.reef.recordings.point_clouds import points_in, range_image_of
from coral.reef.recordings.recording import PosedPing
from coral.reef.recordings.transforms import euler_of
from coral.reef.vehicle.sensing import Attitude
from coral.reef.world.geometry import Pose
from coral.ros.bag_reader import Bag

Hear = Callable[[float, Any], tuple[PosedPing | None, NDArray[np.float64]]]
"""Returns a cloud, given its time (s), as a range image with its place, and its points in the camera's optical frame.

The range image is None where no pose is near in time. Points have Shape=(N, 3), metres. It raises an InputError if the
message is no cloud.
"""


def open_sonar(
    bag: Bag,
    topic: str,
    track: BodyTrack,
    camera_mount: Callable[[float], NDArray[np.float64] | None],
    sonar: SonarCfg | None,
) -> tuple[SonarCfg, Hear]:
    """Prepare for the echoes on a topic that has some: the sonar's beams and tilt, and how to hear a cloud.

    `camera_mount` is T_camera^body at a time, optical; None where nobody knows. Shape=(4, 4).

    Raises:
        InputError: Nobody knows where on the vehicle the sonar is.
    """
    frame = frame_name(str(next(bag.read_messages({topic}))[1].header.frame_id))
    mount = track.tree.first(track.child, frame)
    if mount is None:
        raise InputError(bag.where, "/tf, /tf_static", f"no chain from {track.child} to {frame or 'the sonar'}", "one")
    down = math.asin(max(-1.0, min(1.0, -float(mount[2, 0]))))
    cfg = replace(sonar or SonarCfg(), enabled=True, pitch_down_deg=round(math.degrees(down), 9))
    tilt = np.eye(4)
    tilt[:3, :3] = sonar_attitude(0.0, 0.0, 0.0, cfg.pitch_down_deg)
    turned = mount @ np.linalg.inv(tilt)  # from a body with the sonar at its origin, tilted so, to the bag's body

    def hear(t: float, message: Any) -> tuple[PosedPing | None, NDArray[np.float64]]:
        points = points_in(message, f"{bag.where} at {t:.3f} s")
        camera, at = camera_mount(t), track.at(t)
        if at is None or camera is None:
            return None, np.empty((0, 3))
        to_camera = np.linalg.inv(camera) @ mount
        seen = points @ to_camera[:3, :3].T + to_camera[:3, 3]
        body = at[0] @ turned
        roll, pitch, yaw = euler_of(body[:3, :3])
        attitude = Attitude(roll=roll, pitch=pitch, depth_m=math.inf, altitude_m=float(body[2, 3]))
        pose = Pose(float(body[0, 3]), float(body[1, 3]), yaw)
        return PosedPing(t=t, pose=pose, attitude=attitude, image=range_image_of(points, cfg)), seen

    return cfg, hear

"""`coral contact poses`: track the objects of a task in a camera's pictures, and send their poses."""

from __future__ import annotations

import socket
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Annotated, Any

import cv2
import numpy as np

from coral.contact.perception.tracker import PoseEstimate
from coral.contact.perception.tracker_registry import TRACKERS, choose_tracker
from coral.contact.real_scenes.camera_pose_file import read_camera_pose
from coral.contact.real_scenes.cameras.rgbd_camera import CAMERAS, make_camera_by_name, stream_frames
from coral.contact.real_scenes.masks.mask_source import MASKS
from coral.contact.real_scenes.object_tracking import track_objects
from coral.contact.real_scenes.pose_picture import draw_poses
from coral.contact.scene.geometry import matrix_to_body, quaternion_of
from coral.contact.scene.task_names import shipped_tasks
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.errors import InputError, RunError
from coral.file_writer import write_whole
from coral.flags import Argument, Option, forms_text
from coral.terminal import tell


@dataclass(frozen=True, kw_only=True)
class ContactPoses:
    """Track the objects of a task in a camera's pictures. Their poses go to a Franka world, or to your own program.

    No true pose or mask is read: shapes, symmetries and colours are those of the task file.
    """

    task: Annotated[str, Argument(metavar="TASK", names=shipped_tasks)]
    """A shipped task or a task file, with the exact sizes of your objects."""
    camera: Annotated[str, Option(metavar="CAMERA", help=f"The camera: {forms_text(CAMERAS)}.")]
    camera_pose: Path | None = None
    """File that says where it stands; by default its frame is the world's."""
    masks: Annotated[str, Option(metavar="MASKS", help=f"What segments the pictures: {forms_text(MASKS)}.")] = "colour"
    tracker: Annotated[str, Option(help=f"The tracker: {forms_text(TRACKERS)}.")] = "model"
    seed: int = 0
    """Seed of the trial, if the task file leaves sizes open."""
    send: Annotated[str | None, Option(metavar="HOST:PORT")] = None
    """Send the poses of objects that are not lost as UDP datagrams, as coral contact run --world franka takes them."""
    pictures: int = 0
    """End after this many pictures; 0 for the end of the recording, or Ctrl-C."""
    picture: Annotated[Path | None, Option(metavar="PNG")] = None
    """Write the last picture with the objects' outlines into this file, new."""
    json: bool = False
    """Print one JSON object on standard output."""
    quiet: bool = False
    """No line for each picture."""

    def __call__(self) -> Mapping[str, Any]:
        if self.pictures < 0:
            raise InputError("--pictures", "", self.pictures, "0 or more")
        if self.picture is not None and self.picture.exists():
            raise InputError("--picture", "", str(self.picture), "a new file")
        to = None if self.send is None else parse_receiver(self.send)
        trial = sample_trial(load_task(self.task), self.seed)
        tracking = track_objects(trial, choose_tracker(self.tracker), self.masks)
        placed = None if self.camera_pose is None else read_camera_pose(self.camera_pose)
        pictures, lost = 0, dict.fromkeys(tracking.models, 0)
        seen: dict[str, PoseEstimate] = {}
        last = None
        with (
            closing(make_camera_by_name(self.camera, placed)) as camera,
            closing(tracking),
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender,
        ):
            camera.start()
            try:
                for frame in islice(stream_frames(camera), self.pictures or None):
                    found = tracking.update(frame)
                    last = frame, found
                    pictures += 1
                    seen |= (shown := {name: one for name, one in found.items() if not one.lost})
                    for name, one in found.items():
                        lost[name] += one.lost
                    if to is not None:
                        from coral.contact.franka.object_poses import poses_datagram

                        bodies = {name: matrix_to_body(one.T_world_object) for name, one in shown.items()}
                        sender.sendto(poses_datagram(bodies), to)
                    if not self.quiet and not self.json:
                        tell(_line(frame.time_s, found))
            except KeyboardInterrupt:
                if last is None:
                    raise
        if last is None:
            raise RunError(f"the camera {self.camera} sent no picture")
        if self.picture is not None:
            drawn = draw_poses(last[0], tracking.models, last[1])
            write_whole(self.picture, cv2.imencode(".png", drawn[..., ::-1])[1].tobytes())
        return {
            "camera": self.camera,
            "masks": self.masks,
            "pictures": pictures,
            "objects": {
                name: {"pictures": pictures, "lost": lost[name], "reason": one.reason, **_pose(seen.get(name))}
                for name, one in last[1].items()
            },
            "picture": None if self.picture is None else str(self.picture),
        }

    def describe(self, result: Mapping[str, Any]) -> str:
        lines = []
        for name, one in result["objects"].items():
            if one["position_m"] is None:
                lines.append(f"{name}: never found in {one['pictures']} pictures ({one['reason']})")
                continue
            x, y, z = one["position_m"]
            lost = f", lost in {one['lost']} of {one['pictures']} pictures" if one["lost"] else ""
            now = f"; lost now ({one['reason']})" if one["reason"] else ""
            lines.append(f"{name}: last at {x:+.3f} {y:+.3f} {z:+.3f} m, confidence {one['confidence']:.2f}{lost}{now}")
        return "\n".join([*lines, *([f"picture: {result['picture']}"] if result["picture"] else [])])


def _pose(estimate: PoseEstimate | None) -> dict[str, Any]:
    if estimate is None:
        return {"position_m": None, "quaternion": None, "confidence": None}
    pose = estimate.T_world_object
    return {
        "position_m": np.round(pose[:3, 3], 5).tolist(),
        "quaternion": np.round(quaternion_of(pose[:3, :3]), 6).tolist(),
        "confidence": round(float(estimate.confidence), 3),
    }


def parse_receiver(word: str, where: str = "--send") -> tuple[str, int]:
    """Return host and port.

    Raises:
        InputError: The word is not HOST:PORT.
    """
    host, _, port = word.rpartition(":")
    if not host or not port.isascii() or not port.isdecimal() or not 0 < int(port) < 65_536:
        raise InputError(where, "", repr(word), "HOST:PORT")
    try:
        return socket.gethostbyname(host), int(port)
    except OSError as error:
        raise InputError(where, "", f"{host!r} ({error.strerror})", "a host that is known") from None


def _line(time_s: float, found: Mapping[str, Any]) -> str:
    parts = []
    for name, one in found.items():
        x, y, z = one.T_world_object[:3, 3]
        parts.append(f"{name} lost ({one.reason})" if one.lost else f"{name} at {x:+.3f} {y:+.3f} {z:+.3f} m")
    return f"{time_s:8.2f} s: {'; '.join(parts)}"

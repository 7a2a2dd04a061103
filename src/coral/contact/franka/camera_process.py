"""Camera and trackers in a process of their own, whose datagrams give a Franka world the objects' poses.

An object that is lost is not in a datagram, so that its pose ages and the arm stops: nothing is guessed. The arm tells
its hand's pose and opening, as it measures them; what the fingers hold moves with the hand, seen or not.
"""

from __future__ import annotations

import os
import socket
import time
from contextlib import closing, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from coral.contact.franka.child_process import ChildProcess, get_ready, leave_interrupts_to_the_program
from coral.contact.franka.object_poses import poses_datagram
from coral.contact.franka.shared_block import SharedBlock
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.perception.tracked_world import nominal_pose
from coral.contact.real_scenes.camera_pose_file import read_camera_pose
from coral.contact.real_scenes.cameras.drawn_camera import DrawnRgbdCamera
from coral.contact.real_scenes.cameras.rgbd_camera import RgbdCamera, make_camera_by_name
from coral.contact.real_scenes.hand_mask import HandReading
from coral.contact.real_scenes.object_tracking import ObjectTracking, object_models, track_objects
from coral.contact.real_scenes.posed_scene import PosedScene, scene_at_start
from coral.contact.scene.geometry import matrix_to_body
from coral.contact.scene.observation import Observation
from coral.contact.scene.trial import Trial
from coral.errors import InputError, RunError

SIMULATED = "sim"
_POLL_S = 0.002


@dataclass(frozen=True)
class CameraJob:
    """What the process does."""

    trial: Trial
    camera: str
    """The camera, as `--camera` takes it; `SIMULATED` for the simulated arm's."""
    masks: str
    """What segments its pictures, as `--masks` takes it."""
    camera_pose: Path | None
    """File that says where the camera stands."""
    tracked: TrackedCfg
    """The tracker; of a simulated camera, its size, place and noise too."""
    poses_to: tuple[str, int]
    """Receiver of the poses."""
    state: SharedBlock[Observation | None] | None = None
    """Of the simulated arm, which its camera draws."""


class CameraProcess:
    """Starts the camera, and tracks until it is closed.

    Raises:
        InputError, RunError: The camera or the masks cannot be used.
    """

    def __init__(self, job: CameraJob) -> None:
        # No pipe for the hand: it would fill up, and the arm wait, while a tracker is slow.
        self._hand: SharedBlock[HandReading | None] = SharedBlock(None)
        self.child = ChildProcess("the camera's process", _run, (job, self._hand))

    def failure(self) -> str:
        """Return why tracking has ended; "" while it runs."""
        try:
            return str(self.child.connection.recv()) if self.child.connection.poll(0.0) else ""
        except (EOFError, OSError):
            return "the camera's process has ended"

    def tell_hand(self, hand: HandReading) -> None:
        """Tell what the arm measures of its hand now; newer readings replace older ones. It never waits."""
        self._hand.write(hand)

    def close(self) -> None:
        """Stop the camera and end the process."""
        with suppress(OSError):
            self.child.connection.send("stop")
        self.child.end()


def _run(job: CameraJob, told: SharedBlock[HandReading | None], connection: Connection) -> None:
    leave_interrupts_to_the_program()
    camera, tracking = get_ready(connection, lambda: _prepare(job))
    parent = os.getppid()
    with closing(camera), closing(tracking), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        try:
            while not connection.poll() and os.getppid() == parent:
                frame = camera.newest()
                if frame is None:
                    time.sleep(_POLL_S)
                    continue
                found = tracking.update(frame, told.read())
                held = {name: matrix_to_body(T) for name, T in tracking.in_hand.items()}
                seen = {name: matrix_to_body(one.T_world_object) for name, one in found.items() if not one.lost}
                sender.sendto(poses_datagram(seen | held, held), job.poses_to)
        except (InputError, RunError) as error:
            connection.send(str(error))


def warm_up(job: CameraJob) -> None:
    """Track a drawn picture, so that what is compiled at its first use is compiled before an arm waits for poses."""
    if job.tracked.by != TrackedCfg().by:  # another tracker's server is not bothered
        return
    trial, models = job.trial, object_models(job.trial)
    scene, start, rng = PosedScene(trial, job.tracked), scene_at_start(trial), np.random.default_rng(0)
    for name, model in models.items():
        with closing(job.tracked.choice().make(model, nominal_pose(trial, name))) as tracker:
            for _ in range(2):
                frame = scene.take(start, rng)
                tracker.track(frame, frame.mask(name))


def _prepare(job: CameraJob) -> tuple[RgbdCamera, ObjectTracking]:
    warm_up(job)
    tracking = track_objects(job.trial, job.tracked.choice(), job.masks)
    placed = None if job.camera_pose is None else read_camera_pose(job.camera_pose)
    if job.camera == SIMULATED and job.state is not None:
        camera: RgbdCamera = DrawnRgbdCamera(job.trial, job.tracked, job.state.read, placed)
    else:
        camera = make_camera_by_name(job.camera, placed)
    camera.start()
    return camera, tracking

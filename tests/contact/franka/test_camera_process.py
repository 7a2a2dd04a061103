"""The process runs in a thread here, against a drawn camera and a receiver on a loopback port."""

import dataclasses
import threading
from types import SimpleNamespace

import numpy as np
import pytest

from coral.contact.franka import camera_process
from coral.contact.franka.camera_process import CameraJob, CameraProcess
from coral.contact.franka.object_poses import ObjectPoses
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.perception.tracker import PoseEstimate
from coral.contact.real_scenes.hand_mask import HandReading
from coral.contact.scene.observation import BodyState
from coral.errors import InputError, RunError

pytestmark = pytest.mark.usefixtures("in_threads")


@pytest.fixture
def poses():
    poses = ObjectPoses(("box", "can"), "127.0.0.1", 0)
    yield poses
    poses.close()


@pytest.fixture
def job(trial, tmp_path, poses):
    """A camera of some pictures; colours of the fixture's objects are equal, so a file names them."""
    (tmp_path / "colours.yaml").write_text("objects: {box: {hue_deg: [0, 60]}, can: {hue_deg: [0, 60]}}")
    return CameraJob(
        trial, "drawn:pick-box", f"colour:{tmp_path / 'colours.yaml'}", None, TrackedCfg(), ("127.0.0.1", poses.port)
    )


class Stub:
    """Sees the box and has lost the can."""

    def __init__(self, fails=False):
        self.fails, self.tracked = fails, threading.Event()

    in_hand = {}

    def update(self, frame, hand=None):
        self.tracked.set()
        if self.fails:
            raise RunError("the tracker's server does not answer")
        if hand is not None:
            self.in_hand = {"can": hand.T_world_tool}
        placed = np.eye(4)
        placed[0, 3] = 0.25
        return {"box": PoseEstimate(placed, 1.0), "can": PoseEstimate(np.eye(4), 0.0, lost=True, reason="covered")}

    def close(self):
        pass


def started(job, stub, monkeypatch):
    prepare = camera_process._prepare
    monkeypatch.setattr(camera_process, "_prepare", lambda job: (prepare(job)[0], stub))
    process = CameraProcess(job)
    assert stub.tracked.wait(10.0)
    return process


def test_a_lost_object_is_not_sent(job, poses, monkeypatch):
    stub = Stub()
    process = started(job, stub, monkeypatch)
    process.close()
    poses.update(1.0)
    assert poses.poses["box"].position[0] == pytest.approx(0.25)
    assert poses.oldest(1.0)[0] == "can"
    assert poses.oldest(1.0)[1] == float("inf")


def test_a_tracker_that_fails_says_why(job, monkeypatch):
    process = started(job, Stub(fails=True), monkeypatch)
    process.child.process.join(5.0)
    assert "does not answer" in process.failure()
    process.close()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")  # it ends by SystemExit
def test_a_wrong_camera_is_one_line(job, tmp_path):
    with pytest.raises(InputError, match="--camera"):
        CameraProcess(dataclasses.replace(job, camera="kinect"))
    placed = "{format: coral-camera-pose/1, position_m: [0, 0, 0], quaternion: [1, 0, 0, 0]}"
    (tmp_path / "camera.yaml").write_text(placed)
    with pytest.raises(InputError, match="did you mean 'colour'"):
        CameraProcess(dataclasses.replace(job, masks="color", camera_pose=tmp_path / "camera.yaml"))


class Patient:
    """A camera of two pictures, which come when they are allowed."""

    def __init__(self):
        self.allowed, self.left = threading.Event(), 2

    def start(self):
        pass

    def newest(self):
        self.allowed.wait(10.0)
        self.left -= 1
        return "picture" if self.left >= 0 else None

    def close(self):
        pass


def test_what_is_held_is_sent_in_the_tools_frame(job, poses, monkeypatch):
    camera, stub = Patient(), Stub()
    monkeypatch.setattr(camera_process, "_prepare", lambda job: (camera, stub))
    process = CameraProcess(job)
    for _ in range(2000):  # a slow tracker does not make the arm wait
        process.tell_hand(HandReading(np.eye(4), 0.05, 0.02))
    camera.allowed.set()
    process.child.process.join(0.2)
    process.close()
    poses.update(1.0, BodyState(np.array([0.0, 0.0, 0.4]), np.array([1.0, 0, 0, 0])))
    assert poses.poses["can"].position == pytest.approx([0.0, 0.0, 0.4])


def test_trackers_are_compiled_before_poses_are_awaited(job, monkeypatch):
    """On a fresh machine the first pictures took so long that an arm stopped for lost poses."""
    tracked = []

    class Tracker:
        def track(self, frame, mask):
            tracked.append(mask.any())

        def close(self):
            tracked.append("closed")

    other = TrackedCfg(by="foundationpose:http://127.0.0.1:9")
    monkeypatch.setattr(TrackedCfg, "choice", lambda self: SimpleNamespace(make=lambda model, expected: Tracker()))
    camera_process.warm_up(job)
    assert tracked == [True, True, "closed"] * 2
    tracked.clear()
    camera_process.warm_up(dataclasses.replace(job, tracked=other))
    assert tracked == []

"""The stream of the camera of rehearsals over loopback. Waiting is for a picture, never for a time."""

import time

import numpy as np
import pytest

from autopilot.camera import Judge, MjpegServer, repeating
from coral.reef.sea.video_camera import VideoCamera
from coral.reef.simulation.simulator import SimulatorCfg
from coral.reef.world.find_world import find_world
from coral.reef.world.geometry import Pose


@pytest.fixture
def stream():
    server = MjpegServer(latency_s=0.01)
    yield server
    server.close()


def grey(value):
    return np.full((120, 160, 3), value, np.uint8)


def test_pictures_arrive_as_a_real_camera_reads_them(stream):
    with repeating(lambda: (stream.offer(grey(90)), time.sleep(0.02))):
        camera = VideoCamera(stream.address)
        shot = camera.read()
        camera.close()
    assert shot.rgb.shape == (120, 160, 3)
    assert abs(int(shot.rgb.mean()) - 90) < 3


def test_a_lost_picture_is_never_sent():
    server = MjpegServer(dropped=0.5, seed=1)
    for _ in range(100):
        server.offer(grey(0))
    sent = server.latest[0] + len(server.waiting)
    server.close()
    assert 35 <= sent <= 65


def test_the_judge_counts_contacts_and_what_was_inspected(tmp_path):
    world = find_world("s1")
    judge = Judge(world, SimulatorCfg(), tmp_path)
    judge.follow(Pose(world.start.x, world.start.y, world.start.theta))
    assert judge.verdict()["contacts"] == 0
    rock = world.obstacles[0]
    judge.follow(Pose(rock.x, rock.y, 0.0))
    found = judge.verdict()
    assert found["contacts"] >= 1
    assert found["least_clearance_m"] < 0.0
    assert 0.0 <= found["inspected"] <= 1.0

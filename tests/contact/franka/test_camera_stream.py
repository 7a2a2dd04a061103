from types import SimpleNamespace

import numpy as np
import pytest

from coral.contact.franka.camera_stream import CameraStream
from coral.contact.franka.stream import StopCause
from coral.contact.scene.observation import BodyState, HandTarget

UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
BASE = (-0.5, 0.0, 0.0)
REPORT = SimpleNamespace(tool=BodyState(np.array([0.6, 0.1, 0.2]), UPRIGHT), opening_m=0.05)
TARGET = HandTarget(np.zeros(3), UPRIGHT, 0.01, 600.0)


class Recorder:
    def __init__(self, log, name):
        self._log, self._name = log, name

    def __getattr__(self, verb):
        def call(*words):
            self._log.append((self._name, verb, *words))
            return REPORT if verb == "report" else None

        return call


def test_the_stream_is_passed_on_and_the_camera_closed_after_it():
    log = []
    stream = CameraStream(Recorder(log, "stream"), Recorder(log, "camera"), BASE)
    stream.start()
    stream.stop(StopCause.END)
    stream.report()
    stream.close()
    assert [entry[:2] for entry in log] == [
        ("stream", "start"),
        ("stream", "stop"),
        ("stream", "report"),
        ("stream", "close"),
        ("camera", "close"),
    ]


def test_the_camera_is_told_of_the_hand_in_the_world():
    log = []
    CameraStream(Recorder(log, "stream"), Recorder(log, "camera"), BASE).follow(TARGET)
    assert ("stream", "follow", TARGET) in log
    (told,) = [entry[2] for entry in log if entry[:2] == ("camera", "tell_hand")]
    assert told.T_world_tool[:3, 3] == pytest.approx([0.1, 0.1, 0.2])
    assert (told.opening_m, told.wanted_m) == (0.05, 0.01)


def test_the_reason_tells_that_the_camera_failed():
    stream = SimpleNamespace(reason=lambda: "box was not seen for 0.25 s")
    fine, broken = SimpleNamespace(failure=lambda: ""), SimpleNamespace(failure=lambda: "unplugged")
    assert CameraStream(stream, fine, BASE).reason() == "box was not seen for 0.25 s"
    assert CameraStream(stream, broken, BASE).reason() == "box was not seen for 0.25 s: unplugged"

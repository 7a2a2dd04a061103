"""What the guard finds moves the vehicle from state to state."""

import dataclasses

import numpy as np

from coral.reef.pilot.guard import GuardCfg, SensorGuard
from coral.reef.pilot.safety import SafetyWatch
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.sensing import Stamped, VehicleObservation
from coral.reef.vehicle.states import Mover, PilotState
from coral.reef.world.geometry import Frame, Label, Pose

CAMERA = CameraCfg(width=8, height=6)
SHAPE = (6, 8)
FRAME = Frame(
    np.full(SHAPE, 5.0, np.float32), np.full(SHAPE, Label.SEABED, np.uint8), np.full(SHAPE, -1, np.int32)
)  # fmt: skip
FAST = (9.0, 0.0, 0.0)


class Watched:
    """A watch with the events that it told."""

    def __init__(self, **cfg):
        self.events = []
        self.watch = SafetyWatch(SensorGuard(CAMERA, (20.0, 20.0), GuardCfg(**cfg)), self.emit)
        self.t = 0.0

    def emit(self, event, **fields):
        self.events.append({"t": self.t, "event": event, **fields})

    def until(self, t, **changes):
        while self.t < t - 1e-9:
            seen = VehicleObservation.at(self.t, Pose(5.0, 5.0, 0.0), (0.0, 0.0, 0.0), FRAME)
            given = {name: change and Stamped(self.t, change) for name, change in changes.items()}
            self.watch.update(dataclasses.replace(seen, **given))
            self.t = round(self.t + 0.1, 9)
        return self

    def states(self):
        return [(e["t"], e["state"]) for e in self.events if e["event"] == "state"]


def test_it_drives_from_the_first_good_observation_on():
    one = Watched()
    assert not one.watch.driving
    one.until(0.1)
    assert one.watch.driving


def test_while_it_waits_it_says_for_what():
    one = Watched().until(0.5, frame=None)
    assert one.watch.states.state is PilotState.READY
    assert one.watch.states.reason == "waits: camera missing"
    assert one.events == []


def test_it_holds_when_an_input_is_lost_and_goes_on_a_second_after_it_is_back():
    one = Watched(pose_timeout_s=0.5, recover_s=1.0).until(1.0).until(3.0, pose=None).until(6.0)
    assert one.states() == [(0.0, "surveying"), (1.5, "holding"), (4.0, "surveying")]


def test_an_input_that_comes_and_goes_does_not_make_it_start_and_stop():
    one = Watched(recover_s=1.0, pose_timeout_s=0.3).until(1.0).until(2.0, pose=None)
    for k in range(10):
        one.until(2.5 + k, pose=None).until(3.0 + k)
    assert [state for _, state in one.states()] == ["surveying", "holding"]


def test_it_surfaces_after_the_configured_time_or_never():
    assert Watched(surface_after_s=2.0).until(1.0).until(9.0, pose=None).states()[-1] == (3.4, "surfacing")
    assert Watched(surface_after_s=None).until(1.0).until(90.0, pose=None).states()[-1] == (1.4, "holding")


def test_what_is_refused_is_told_once_and_once_more_when_it_is_good_again():
    one = Watched().until(1.0).until(1.3, velocity=FAST).until(2.0)
    told = [e for e in one.events if e["event"] == "sensor"]
    assert [(e["t"], e["input"], e["refused"]) for e in told] == [(1.0, "velocity", "too fast"), (1.3, "velocity", "")]


def test_a_state_is_told_with_all_that_the_table_knows():
    one = Watched().until(1.0).until(2.0, frame=None)
    assert one.events[-1] == {
        "t": 1.3, "event": "state", "state": "holding", "was": "surveying", "cause": "sensors lost", "by": "guard",
        "reason": "camera missing, for 0.4 s",
    }  # fmt: skip


def test_a_hold_of_the_operator_outlasts_the_sensors():
    one = Watched().until(1.0)
    one.watch.states.move(one.t, Mover.OPERATOR, "hold")
    one.until(2.0, frame=None).until(5.0)
    assert one.watch.states.state is PilotState.HOLDING

"""Faults on command."""

import dataclasses

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.pilot.guard import SensorGuard
from coral.reef.simulation.faults import FAULTS, FaultySensors, SensorFault, parse_fault
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.vehicle.sensing import Stamped, VehicleObservation
from coral.reef.world.geometry import Frame, Label, Pose

CAMERA = CameraCfg(width=8, height=6)
SMALL = SonarCfg(enabled=True, width=8, height=4)


def seen(t):
    """A vehicle that drives past an oyster, in pictures that change."""
    shape = (CAMERA.height, CAMERA.width)
    frame = Frame(
        np.full(shape, 5.0 + t, np.float32), np.full(shape, Label.OYSTER, np.uint8), np.zeros(shape, np.int32)
    )
    return VehicleObservation.at(t, Pose(5.0 + 0.5 * t, 5.0, 0.0), (0.5, 0.0, 0.0), frame)


@pytest.mark.parametrize("name", FAULTS)
def test_every_fault_is_refused_or_missed_and_passes(name):
    guard, sensors = SensorGuard(CAMERA, (20.0, 20.0)), FaultySensors([SensorFault(name, 2.0, 3.0)])
    readings = {k: guard.check(sensors.apply(seen(k / 10))) for k in range(80)}
    troubled = {k for k, reading in readings.items() if reading.refusals or reading.lost}
    clock = {20, 50} if name.startswith("clock") else set()
    assert troubled == clock or (troubled and min(troubled) >= 20 and max(troubled) < 51)
    assert all(readings[k].frame is not None for k in (*range(20), *range(52, 80)))


def test_outside_of_its_time_a_fault_changes_nothing():
    sensors, one = FaultySensors([parse_fault("blind-camera@2:1")]), seen(1.9)
    assert sensors.apply(one) is one
    assert np.isinf(sensors.apply(seen(2.0)).frame.value.depth).all()
    later = seen(3.0)
    assert sensors.apply(later) is later


def test_a_frozen_picture_is_that_of_the_moment_it_froze():
    sensors = FaultySensors([parse_fault("frozen-frame@2:3")])
    first = sensors.apply(seen(2.0))
    last = sensors.apply(seen(4.5))
    assert last.frame.value is first.frame.value
    assert last.frame.t == 4.5


def test_a_fault_is_read_from_the_command_line():
    assert parse_fault("nan-pose@20:2.5") == SensorFault("nan-pose", 20.0, 2.5)


@pytest.mark.parametrize(
    "text", ["nan-pose", "nan-pose@5", "nan-pose@x:1", "nan-pose@5:-1", "nan-pose@5:inf", "nan-pose@nan:1"]
)
def test_a_fault_without_its_times_is_one_line(text):
    with pytest.raises(InputError, match="blind-camera@20:10"):
        parse_fault(text)


def test_an_unknown_fault_suggests_the_nearest():
    with pytest.raises(InputError, match="did you mean 'blind-camera'"):
        parse_fault("blind-cam@1:1")


def test_every_fault_says_what_it_is():
    assert all(kind.means for kind in FAULTS.values())


@pytest.mark.parametrize(
    ("name", "said"),
    [("blind-sonar", "sonar blind"), ("missing-sonar", "sonar missing"), ("stale-sonar", "sonar stale")],
)
def test_a_fault_of_the_sonar_is_told_while_the_camera_shows_the_way(name, said):
    echo = np.full((SMALL.height, SMALL.width), 4.0, np.float32)
    guard, sensors = SensorGuard(CAMERA, (20.0, 20.0), sonar=SMALL), FaultySensors([SensorFault(name, 2.0, 3.0)])
    readings = {}
    for k in range(80):
        image = RangeImage(echo + 0.01 * k, SMALL.hfov_deg, SMALL.vfov_deg)
        now = dataclasses.replace(seen(k / 10), sonar=Stamped(k / 10, image))
        readings[k] = guard.check(sensors.apply(now))
    deaf = [k for k, reading in readings.items() if reading.deaf]
    assert (min(deaf), max(deaf)) == (23, 49)
    assert readings[30].deaf.startswith(said)
    assert not any(reading.lost for reading in readings.values())

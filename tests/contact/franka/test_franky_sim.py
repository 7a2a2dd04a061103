"""The driver against franky-sim's arm with contact forces added, over the arm's own protocol; `make test-franka`."""

import time

import numpy as np
import pytest

from coral.contact.franka.double import Double, cfg_for_double
from coral.contact.franka.stream import Phase, StopCause
from coral.contact.franka.stream_process import StreamProcess
from coral.contact.franka.world import FrankaDoubleWorld
from coral.contact.scene.observation import HandTarget
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.contact.worlds.robot_world import WorldError

pytestmark = pytest.mark.franka
STEP_S = 0.02
PADS_M = 0.008
"""The closed fingertips reach so far beyond the tool."""


@pytest.fixture
def arm():
    from coral.contact.franka.franky_arm import FrankyArm

    trial = sample_trial(load_task("pick-box"), 0, "pick-box")
    cfg = cfg_for_double(FrankaCfg(poses_port=0))
    double = Double(trial, cfg, 0.5)  # half as fast as the machine's clock: others use it too
    stream = StreamProcess(FrankyArm, double.address, cfg, trial)
    double.send_poses_to(cfg.poses_host, stream.poses_port)
    world = FrankaDoubleWorld(stream, cfg, STEP_S, list(trial.objects), double=double)
    yield world
    world.close()


def lead(world, start, goal, speed_m_s, opening_m=0.0, rest_s=1.0):
    """Lead the target from one place to another, wait there, and return the last observation."""
    way = np.asarray(goal) - start.position
    steps = max(1, round(np.linalg.norm(way) / speed_m_s / STEP_S))
    for step in range(1, steps + round(rest_s / STEP_S)):
        place = start.position + min(1.0, step / steps) * way
        now = world.step(HandTarget(place, start.quaternion, opening_m, 600.0))
    return now


def test_it_goes_where_it_is_told_and_sees_the_box(arm):
    first = arm.reset()
    truth = arm.truth()
    assert first.objects["box"].position == pytest.approx(truth.objects["box"].position, abs=0.006)
    goal = np.add(first.tool.position, [-0.05, 0.06, -0.04])
    now = lead(arm, first.tool, goal, 0.2)
    assert now.tool.position == pytest.approx(goal, abs=0.02)
    assert np.linalg.norm(now.wrench[:3]) < 2.0  # the bias of 1 to 2 N was measured and taken off
    assert now.opening_m < 0.01


def test_led_into_the_box_with_half_a_metre_a_second_it_presses_and_does_not_hit(arm):
    first = arm.reset()
    box = arm.truth().objects["box"].position
    above = np.add(box, [0.0, 0.0, box[2] + PADS_M + 0.1])
    reached = lead(arm, first.tool, above, 0.15)
    arm.truth()
    pressed = lead(arm, reached.tool, np.subtract(above, [0.0, 0.0, 0.2]), 0.5, rest_s=2.0)
    limits = FrankaCfg().limits
    assert arm.truth().hand_forces["box"].peak < limits.contact_force_n  # since the truth was asked
    assert pressed.wrench[2] == pytest.approx(limits.push_n, abs=6.0)
    assert arm.stream.report().phase is Phase.FOLLOWING


def test_a_stop_by_the_page_comes_within_fifty_milliseconds_and_the_arm_rests(arm):
    first = arm.reset()
    lead(arm, first.tool, np.add(first.tool.position, [0.0, 0.1, 0.0]), 0.2, rest_s=0.0)
    asked = time.monotonic()
    arm.stream.stop(StopCause.PAGE)
    while arm.stream.report().phase is not Phase.STOPPED:
        assert time.monotonic() - asked < 0.05
    with pytest.raises(WorldError):
        lead(arm, first.tool, first.tool.position, 0.2)
    time.sleep(1.0)
    report = arm.stream.report()
    assert (report.phase, report.cause) == (Phase.STOPPED, StopCause.PAGE)
    assert np.linalg.norm(report.tool.velocity) < 0.01

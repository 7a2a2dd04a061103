"""Each limit stops the state beyond it, and no other; targets stay within them."""

import numpy as np
import pytest
from arms import DOWN, START, TOOL, arm_state

from coral.contact.scene.geometry import angle_between, from_rotvec, multiply
from coral.contact.scene.observation import HandTarget
from coral.contact.worlds.franka.limits import JOINT_SPEED, ArmLimitsCfg, Limits

BASE = np.array([-0.5, 0.0, 0.0])
LIMITS = Limits(ArmLimitsCfg(), BASE, 0.05)
NOTHING = np.zeros(6)


def changed(base, index, value):
    values = np.array(base, float)
    values[index] = value
    return values


def test_the_start_posture_violates_nothing():
    assert LIMITS.violation(arm_state(), NOTHING) == ""


@pytest.mark.parametrize(
    ("state", "wrench", "words"),
    [
        (arm_state(joints=changed(START, 3, -3.03)), NOTHING, "joint 4 is"),
        (arm_state(joint_speeds=0.9 * JOINT_SPEED * np.eye(7)[6]), NOTHING, "joint 7 moves with 90%"),
        (arm_state(twist=changed(NOTHING, 0, 0.9)), NOTHING, "0.90 m/s"),
        (arm_state(position=np.subtract(TOOL, [0, 0, 0.35])), NOTHING, "outside of its workspace"),
        (arm_state(), changed(NOTHING, 1, 37.0), "force of 37 N"),
        (arm_state(), changed(NOTHING, 4, 13.0), "torque of 13.0 N m"),
        (arm_state(joints=np.array([0.0, -1.7, 0.0, -2.98, 0.0, 0.6, 0.0])), NOTHING, "two links are"),
        (arm_state(position=np.array([np.nan, 0, 0])), NOTHING, "not a finite number"),
    ],
)
def test_a_state_beyond_a_limit_is_named(state, wrench, words):
    assert words in LIMITS.violation(state, wrench)


def target(offset, quaternion=DOWN, force=(0, 0, 0)):
    return HandTarget(TOOL + offset, quaternion, 0.08, 600.0, np.array(force, float))


def test_a_near_target_is_left_alone():
    found = LIMITS.bounded(target([0.02, 0.01, 0.0]), arm_state(), NOTHING)
    assert found.position == pytest.approx(np.add(TOOL, [0.02, 0.01, 0.0]))
    assert found.quaternion == pytest.approx(DOWN)


def test_the_pull_is_bounded_and_an_additional_force_counts_as_pull():
    far = LIMITS.bounded(target([0.2, 0.0, 0.0]), arm_state(), NOTHING)
    assert 600.0 * np.linalg.norm(far.position - TOOL) == pytest.approx(30.0)
    pushed = LIMITS.bounded(target([0.0, 0.0, 0.0], force=(0, 6.0, 0)), arm_state(), NOTHING)
    assert pushed.position == pytest.approx(np.add(TOOL, [0.0, 0.01, 0.0]))
    assert pushed.force == pytest.approx(np.zeros(3))


def test_against_a_large_measured_force_the_pull_yields_but_not_along_it():
    wrench = np.array([0.0, 0.0, 40.0, 0, 0, 0])  # the table pushes the hand up
    found = LIMITS.bounded(target([0.02, 0.0, -0.04]), arm_state(), wrench)
    assert found.position - TOOL == pytest.approx([0.02, 0.0, -0.03])
    away = LIMITS.bounded(target([0.0, 0.0, 0.04]), arm_state(), wrench)
    assert away.position - TOOL == pytest.approx([0.0, 0.0, 0.04])


def test_a_target_outside_of_the_workspace_is_clipped_to_it():
    low = arm_state(position=np.array([0.5, 0.0, 0.01]))
    found = LIMITS.bounded(HandTarget(np.array([0.5, 0.0, -0.02]), DOWN, 0.08, 600.0), low, NOTHING)
    assert found.position[2] == pytest.approx(ArmLimitsCfg().workspace_low_m[2])


def test_the_turning_torque_is_bounded():
    turned = multiply(from_rotvec([0, 0, 1.0]), DOWN)
    found = LIMITS.bounded(target([0, 0, 0], turned), arm_state(), NOTHING)
    assert float(angle_between(found.quaternion, DOWN)) * 600.0 * 0.05 == pytest.approx(5.0, rel=1e-3)

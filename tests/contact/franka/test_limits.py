"""Each limit stops the state beyond it, and no other; targets stay within them."""

from dataclasses import replace

import numpy as np
import pytest
from arms import DOWN, START, TOOL, arm_state

from coral.contact.franka.hand_gaps import Gap
from coral.contact.franka.limits import JOINT_SPEED, Limits
from coral.contact.scene.geometry import angle_between, from_rotvec, multiply
from coral.contact.scene.observation import HandTarget
from coral.contact.worlds.franka_cfg import ArmLimitsCfg, FrankaCfg

CFG = ArmLimitsCfg(push_n=30.0, touch_speed_m_s=0.03, slow_down_s=0.15, push_speed_m_s=0.1, closing_gain=0.0)
LIMITS = Limits(FrankaCfg(limits=CFG))
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


def gap(direction, distance_m, lever=(0.0, 0.0, 0.0)):
    return Gap(np.array(direction, float), distance_m, np.array(lever, float))


DAMPING = 2 * np.sqrt(600.0 * 4.5)
TOWARDS = [1.0, 0.0, 0.0]


def pull(*gaps, lead=(0.05, 0.0, 0.0), pressing=(0.0, 0.0, 0.0), speed=0.0, limits=LIMITS):
    """The pull, N, that is left of 30 N along x, or of another lead."""
    state = arm_state(twist=np.array([speed, 0.0, 0.0, 0.0, 0.0, 0.0]))
    found = limits.bounded(target(lead), state, NOTHING, gaps, np.array(pressing))
    return 600.0 * (found.position - TOOL)


def test_towards_a_gap_the_pull_is_what_the_allowed_speed_needs():
    assert pull(gap(TOWARDS, 0.0)) == pytest.approx([0.03 * DAMPING, 0, 0])
    assert pull(gap(TOWARDS, 0.015)) == pytest.approx([0.13 * DAMPING, 0, 0])
    assert pull(gap(TOWARDS, 0.1)) == pytest.approx([30.0, 0, 0])


def test_along_a_gap_and_away_from_it_nothing_is_slowed():
    assert pull(gap([0.0, 1.0, 0.0], 0.0)) == pytest.approx([30.0, 0, 0])
    assert pull(gap([-1.0, 0.0, 0.0], 0.0)) == pytest.approx([30.0, 0, 0])


def test_in_a_corner_both_gaps_count():
    found = pull(gap(TOWARDS, 0.0), gap([0.6, 0.8, 0.0], 0.0), lead=(0.035, 0.035, 0.0))
    assert found[0] <= 0.03 * DAMPING + 0.01
    assert found @ [0.6, 0.8, 0.0] <= 0.03 * DAMPING + 0.1


def test_against_what_presses_it_pulls_that_much_more_and_pushes_faster():
    touching = gap(TOWARDS, 0.0)
    assert pull(touching, pressing=(-2.0, 0, 0)) == pytest.approx([2.0 + 0.03 * DAMPING, 0, 0])
    assert pull(touching, pressing=(-5.0, 0, 0)) == pytest.approx([5.0 + 0.065 * DAMPING, 0, 0])
    assert pull(touching, pressing=(-8.0, 0, 0)) == pytest.approx([8.0 + 0.1 * DAMPING, 0, 0])
    assert pull(touching, pressing=(8.0, 0, 0)) == pytest.approx([0.03 * DAMPING, 0, 0])


def test_what_presses_elsewhere_lets_it_meet_nothing_faster():
    assert pull(gap(TOWARDS, 0.006), pressing=(-8.0, 0, 0)) == pytest.approx([8.0 + 0.07 * DAMPING, 0, 0])


def test_a_hand_that_is_too_fast_is_braked_and_a_slow_one_helped():
    limits = Limits(FrankaCfg(limits=replace(CFG, closing_gain=2.0)))
    assert pull(gap(TOWARDS, 0.0), speed=0.08, limits=limits) == pytest.approx([-0.07 * DAMPING, 0, 0])
    assert pull(gap(TOWARDS, 0.0), speed=0.01, limits=limits) == pytest.approx([0.07 * DAMPING, 0, 0])
    assert pull(gap(TOWARDS, 0.0), speed=0.03, limits=limits) == pytest.approx([0.03 * DAMPING, 0, 0])


def test_a_turn_that_closes_a_gap_too_fast_is_reduced():
    turned = multiply(from_rotvec([0.0, 0.0, 0.5]), DOWN)
    lever = (0.0, -0.1, 0.0)  # a turn about z moves this point along x
    free = LIMITS.bounded(target([0, 0, 0], turned), arm_state(), NOTHING)
    slowed = LIMITS.bounded(target([0, 0, 0], turned), arm_state(), NOTHING, [gap(TOWARDS, 0.0, lever)])
    assert angle_between(free.quaternion, DOWN) > 1.5 * angle_between(slowed.quaternion, DOWN)
    spin = angle_between(slowed.quaternion, DOWN) * 30.0 / (2 * np.sqrt(30.0 * 0.1))
    assert 0.1 * spin == pytest.approx(0.03, abs=1e-3)

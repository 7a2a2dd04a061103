import numpy as np
import pytest

from coral.contact.episode.policy_cfg import LiberoCfg
from coral.contact.policy.client import PolicyError
from coral.contact.policy.libero_convention import actions_of, axis_angle, opened, state, target
from coral.contact.scene.geometry import angle_between, from_rotvec, multiply
from coral.contact.scene.observation import BodyState, Observation

CFG = LiberoCfg()
DOWN = np.array([0.0, 1.0, 0.0, 0.0])


def observed(position=(0.1, 0.2, 0.3), quaternion=DOWN, opening=0.06):
    return Observation(0.0, BodyState(np.array(position), np.asarray(quaternion)), opening, np.zeros(6), {})


def test_the_state_is_position_axis_angle_and_both_fingers():
    np.testing.assert_allclose(state(observed(), CFG), [-0.06, 0.2, 1.2, np.pi, 0, 0, 0.03, -0.03], atol=1e-12)


@pytest.mark.parametrize("tilt", [-0.2, 0.0, 0.2])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_hand_that_points_down_never_jumps_to_the_other_half_turn(tilt, sign):
    q = multiply(from_rotvec([tilt, 0, 0]), DOWN)
    np.testing.assert_allclose(axis_angle(sign * q), [np.pi + tilt, 0, 0], atol=1e-9)


def test_no_turn_is_zero():
    np.testing.assert_array_equal(axis_angle(np.array([1.0, 0, 0, 0])), np.zeros(3))


def test_an_action_is_a_step_from_the_measured_pose_in_world_axes():
    wanted = target(observed(), np.array([1.0, -0.5, 0, 0, 0, 0.2, 1]), CFG)
    np.testing.assert_allclose(wanted.position, [0.15, 0.175, 0.3])
    assert angle_between(wanted.quaternion, multiply(from_rotvec([0, 0, 0.1]), DOWN)) == pytest.approx(0, abs=1e-7)


def test_an_action_beyond_one_counts_as_one():
    wanted = target(observed(), np.array([100.0, -100, 0, 50, 0, 0, 1]), CFG)
    np.testing.assert_allclose(wanted.position, [0.15, 0.15, 0.3])
    assert angle_between(wanted.quaternion, DOWN) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("gripper", "last", "moved"),
    [("positive", 1.0, -0.002), ("positive", -0.3, 0.002), ("positive", 0.0, 0.0), ("negative", -1.0, -0.002)],
)
def test_the_last_number_closes_or_opens(gripper, last, moved):
    cfg = LiberoCfg(gripper=gripper)
    assert opened(0.05, np.array([0, 0, 0, 0, 0, 0, last]), cfg) == pytest.approx(0.05 + moved)


def test_the_fingers_close_in_eight_actions_and_then_squeeze():
    opening = 0.08
    for _ in range(8 * CFG.ticks):
        opening = opened(opening, np.ones(7), CFG)
    assert opening == pytest.approx(0.0, abs=1e-9)
    for _ in range(100):
        opening = opened(opening, np.ones(7), CFG)
    assert opening == -0.04


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int32])
def test_actions_are_read_as_numbers(dtype):
    found = actions_of({"actions": np.ones((3, 7), dtype), "server_timing": {}})
    assert (found.shape, found.dtype) == ((3, 7), np.float64)


@pytest.mark.parametrize(
    ("answer", "code", "said"),
    [
        ({}, "bad-actions", "has no actions"),
        ({"actions": [[0.0] * 7]}, "bad-actions", "a list"),
        ({"actions": np.ones((3, 7), bool)}, "bad-actions", "bool"),
        ({"actions": np.zeros(7)}, "bad-actions", "(7,)"),
        ({"actions": np.zeros((10, 8))}, "bad-actions", "(10, 8)"),
        ({"actions": np.zeros((0, 7))}, "bad-actions", "(0, 7)"),
        ({"actions": np.zeros((2, 10, 7))}, "bad-actions", "(2, 10, 7)"),
        ({"actions": np.zeros((1001, 7))}, "bad-actions", "1001"),
        ({"actions": np.array([[0, 0, np.nan, 0, 0, 0, 0]])}, "not-finite", "no number"),
        ({"actions": np.array([[0, 0, 0, 0, 0, 0, np.inf]])}, "not-finite", "no number"),
    ],
)
def test_what_are_no_actions_is_named(answer, code, said):
    with pytest.raises(PolicyError) as failed:
        actions_of(answer)
    assert failed.value.code == code
    assert said in str(failed.value)

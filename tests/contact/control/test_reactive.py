import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from coral.contact.control.hand_model import MAX_OPENING_M, SQUEEZE_M
from coral.contact.control.reactive import Reactive, ReactiveCfg
from coral.contact.scene.observation import BodyState, HandTarget, Observation

DOWN = np.array([0.0, 1.0, 0.0, 0.0])
LOW, HIGH = np.full(3, -0.4), np.full(3, 0.5)
numbers = st.floats(-1.0, 1.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)


def observed(position=(0.0, 0.0, 0.2), force=(0.0, 0.0, 0.0)):
    return Observation(0.0, BodyState(np.asarray(position, float), DOWN), 0.04, np.array([*force, 0.0, 0.0, 0.0]), {})


def target(position, stiffness=600.0, opening=0.04, force=(0.0, 0.0, 0.0)):
    return HandTarget(np.asarray(position, float), DOWN, opening, stiffness, np.asarray(force, float))


def reactive(**fields):
    return Reactive(ReactiveCfg(**fields), 0.02, LOW, HIGH)


def test_without_error_the_plan_is_commanded_as_it_is():
    made = reactive()
    made.observe(np.array([0.0, 0.0, 0.2]), np.zeros(3), observed())
    planned = target([0.02, 0.0, 0.19])
    command = made.command(planned, observed())
    np.testing.assert_allclose(command.position, planned.position, atol=1e-15)
    np.testing.assert_array_equal(command.force, np.zeros(3))


def test_a_position_that_fell_short_is_made_up_for_by_the_gain():
    made = reactive(pose_gain=0.5)
    made.observe(np.array([0.0, 0.0, 0.204]), np.zeros(3), observed())
    np.testing.assert_allclose(made.command(target([0.0, 0.0, 0.2]), observed()).position, [0.0, 0.0, 0.202])


def test_an_error_fades_with_its_time_constant():
    made = reactive(memory_s=0.1)
    made.observe(np.array([0.004, 0.0, 0.2]), np.zeros(3), observed())
    for _ in range(5):
        made.observe(np.array([0.0, 0.0, 0.2]), np.zeros(3), observed())
    np.testing.assert_allclose(made.position_error, [0.004 * np.exp(-1.0), 0.0, 0.0])


def test_within_a_plan_the_error_is_not_counted_twice():
    made = reactive(memory_s=1e9)
    for k, error in enumerate((0.001, 0.002)):
        made.observe(np.array([error, 0.0, 0.2]), np.zeros(3), observed(), k)
    np.testing.assert_allclose(made.position_error, [0.002, 0.0, 0.0])
    made.observe(np.array([0.001, 0.0, 0.2]), np.zeros(3), observed(), 0)
    np.testing.assert_allclose(made.position_error, [0.003, 0.0, 0.0])


def test_less_resistance_than_expected_pushes_further():
    made = reactive(force_gain=1.0, memory_s=1e-6)
    made.observe(np.array([0.0, 0.0, 0.2]), np.array([-2.0, 0.0, 0.0]), observed())  # pushing along +x feels -x
    np.testing.assert_allclose(made.command(target([0.0, 0.0, 0.2]), observed()).force, [2.0, 0.0, 0.0])


def test_feedback_is_bounded():
    made = reactive(pose_gain=1.0, most_m=0.005, force_gain=1.0, most_n=3.0, memory_s=1e-6)
    made.observe(np.array([0.3, 0.0, 0.2]), np.array([80.0, 0.0, 0.0]), observed())
    command = made.command(target([0.0, 0.0, 0.2]), observed())
    np.testing.assert_allclose(command.force, [-3.0, 0.0, 0.0])
    np.testing.assert_allclose(command.position, [0.005, 0.0, 0.2])


def test_switched_off_only_the_limits_are_left():
    made = reactive(enabled=False)
    made.observe(np.array([0.1, 0.1, 0.1]), np.array([50.0, 0.0, 0.0]), observed())
    planned = target([0.01, 0.0, 0.2])
    command = made.command(planned, observed())
    np.testing.assert_allclose(command.position, planned.position, atol=1e-15)


@settings(max_examples=60, deadline=None)
@given(vectors, vectors, vectors, st.floats(100.0, 3000.0), st.floats(-0.5, 0.5))
def test_whatever_is_planned_pull_workspace_and_opening_stay_within_bounds(wanted, error, felt, stiffness, opening):
    made = reactive(force_limit_n=30.0)
    made.observe(np.array([0.0, 0.0, 0.2]) + error, 20 * error, observed())
    now = observed(force=200 * felt)
    command = made.command(target(wanted, stiffness, opening), now)
    lead = command.position - now.tool.position
    assert stiffness * np.linalg.norm(lead + command.force / stiffness) <= 30.0 + 1e-5
    assert (command.position >= LOW).all()
    assert (command.position <= HIGH).all()
    assert SQUEEZE_M <= command.opening_m <= MAX_OPENING_M


@settings(max_examples=40, deadline=None)
@given(vectors, vectors, st.floats(100.0, 3000.0))
def test_a_hand_outside_the_workspace_is_drawn_back_no_harder_than_allowed(wanted, away, stiffness):
    made = reactive(force_limit_n=30.0)
    made.observe(np.zeros(3), 50 * away, observed())
    now = observed(position=HIGH + np.abs(away))
    command = made.command(target(wanted, stiffness), now)
    assert stiffness * np.linalg.norm(command.position - now.tool.position + command.force / stiffness) <= 30.0 + 1e-5
    assert (
        np.abs(command.position - np.clip(command.position, LOW, HIGH))
        <= np.abs(now.tool.position - np.clip(now.tool.position, LOW, HIGH)) + 1e-9
    ).all()


def test_what_is_felt_beyond_the_limit_makes_the_hand_yield_along_it_only():
    made = reactive(force_limit_n=20.0)
    command = made.command(target([0.01, 0.01, 0.2]), observed(force=(-40.0, 0.0, 0.0)))
    np.testing.assert_allclose(command.position, [0.005, 0.01, 0.2])


@pytest.mark.parametrize("wanted", [(0.9, 0.0, 0.2), (0.0, -0.9, 0.2)])
def test_a_command_does_not_leave_the_workspace(wanted):
    made = reactive(force_limit_n=1e6)
    command = made.command(target(wanted), observed())
    np.testing.assert_allclose(command.position, np.clip(wanted, LOW, HIGH))

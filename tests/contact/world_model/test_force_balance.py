import dataclasses

import numpy as np
import pytest

from coral.contact.scene.observation import BodyState, HandTarget, Observation, Transition
from coral.contact.scene.trial import PhysicalParameters, sample_trial
from coral.contact.tasks import load_task
from coral.contact.world_model.force_balance import (
    Balance,
    balance_error,
    balances,
    finger_clearance,
    solve_balance,
)
from coral.contact.world_model.identification import FRICTION, MASS_KG

BOUNDS = np.log([MASS_KG, FRICTION])
TURNED = np.array([0.0, 1.0, 0.0, 0.0])
"""Palm down."""


def history(trial, truth, press, lift_m=0.0, pace_m_s=0.1, tool_m=0.03, count=40):
    """A hand that drags a board along y under a press of so many newtons, or holds it up; as physics says it feels."""
    board = trial.objects["board"].pose
    steps = []
    for k in range(count):

        def seen(k):
            way = np.array([0.0, pace_m_s * 0.02 * k, lift_m])
            tool = BodyState(board.position + way + [0.0, -0.1, tool_m], TURNED, np.array([0.0, pace_m_s, 0.0]))
            force = (
                np.array([0.0, -truth.friction * (9.81 * truth.mass_kg + press), press])
                if not lift_m
                else np.array([0.0, 0.0, -9.81 * truth.mass_kg])
            )
            return Observation(
                0.02 * k,
                tool,
                0.03,
                np.concatenate([force, np.zeros(3)]),
                {"board": dataclasses.replace(board, position=board.position + way)},
            )

        before, after = seen(k), seen(k + 1)
        steps.append(Transition(before, HandTarget(after.tool.position, TURNED, 0.03, 600.0), after))
    return steps


@pytest.fixture
def trial():
    return sample_trial(load_task("push-pick-board"), 0)


@pytest.mark.parametrize("truth", [PhysicalParameters(0.1, 0.5), PhysicalParameters(0.3, 0.35)])
def test_what_is_dragged_and_then_held_up_tells_both(trial, truth):
    found = [balances(history(trial, truth, press, lift), "board", trial) for press, lift in ((4.0, 0.0), (0.0, 0.06))]
    both = Balance(found[0].dragged, found[1].held)
    assert min(len(found[0].dragged), len(found[1].held)) > 10
    after, covariance = solve_balance(both, BOUNDS)
    assert after.mass_kg == pytest.approx(truth.mass_kg, rel=0.04)
    assert after.friction == pytest.approx(truth.friction, rel=0.04)
    assert np.sqrt(np.diag(covariance)).max() < 0.15
    right, wrong = balance_error(both, [truth, PhysicalParameters(2.0, 0.9)])
    assert right == pytest.approx(0.0, abs=1e-9)
    assert wrong > 1.0


def test_one_press_alone_tells_friction_and_not_mass(trial):
    found = balances(history(trial, PhysicalParameters(0.1, 0.5), 8.0), "board", trial)
    _, covariance = solve_balance(found, BOUNDS)
    assert covariance[0, 0] > 10 * covariance[1, 1]
    assert len(found.held) == 0


def test_single_steps_that_something_else_is_felt_in_do_not_decide(trial):
    held = balances(history(trial, PhysicalParameters(0.1, 0.5), 0.0, 0.06), "board", trial).held.copy()
    held[::4, 0] += 5.0
    after, _ = solve_balance(Balance(np.zeros((0, 3)), held), BOUNDS)
    assert after.mass_kg == pytest.approx(0.1, rel=0.05)


@pytest.mark.parametrize("case", [{"pace_m_s": 0.0}, {"tool_m": 0.003}])
def test_neither_rest_nor_a_finger_that_rubs_on_the_table_counts(trial, case):
    assert len(balances(history(trial, PhysicalParameters(0.1, 0.5), 5.0, **case), "board", trial)) == 0


def test_too_short_a_history_says_nothing(trial):
    assert len(balances(history(trial, PhysicalParameters(0.1, 0.5), 5.0, count=8), "board", trial)) == 0


def test_a_finger_beside_the_table_is_near_nothing(trial):
    step = history(trial, PhysicalParameters(0.1, 0.5), 1.0, count=1)[0]
    assert finger_clearance(trial, step) == pytest.approx(step.after.tool.position[2] - 0.008, abs=1e-9)
    aside = dataclasses.replace(step.after.tool, position=np.array([0.0, 5.0, 0.0]))
    assert (
        finger_clearance(trial, dataclasses.replace(step, after=dataclasses.replace(step.after, tool=aside))) == np.inf
    )

"""A robot's world has no truth and no simulation, and cannot be mistaken for one that has."""

import pytest
from episodes import ObedientRobot, make_trial

from coral.contact.worlds.evaluation_world import EvaluationWorld, simulation_of
from coral.contact.worlds.registry import make_world
from coral.contact.worlds.robot_world import WorldError


def test_only_a_simulated_world_counts_as_one_that_knows_the_truth():
    trial = make_trial()
    robot, simulated = ObedientRobot(trial), make_world("hand", trial, 0.02)
    assert not isinstance(robot, EvaluationWorld)
    assert simulation_of(robot) is None
    assert isinstance(simulated, EvaluationWorld)
    assert simulation_of(simulated).model is simulated.simulation.model


def test_a_fault_has_a_code_and_a_text():
    with pytest.raises(WorldError, match="no picture") as caught:
        raise WorldError("camera-off", "no picture")
    assert caught.value.code == "camera-off"

"""The flags of a robot, before anything is connected."""

import dataclasses

import pytest

from coral import plugins
from coral.commands.robot_flags import RobotFlags, robot_names
from coral.errors import InputError

ARM = RobotFlags(world="franka", robot="10.0.0.1")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"robot": None}, "--robot: found nothing, expected the arm's address"),
        ({"yes": True}, "--yes: found --robot 10.0.0.1, expected --robot sim"),
        ({"world": "hand"}, "--robot: found 10.0.0.1, expected it goes with --world franka only"),
        ({"world": "hand", "robot": None, "dry_run": True}, "--dry-run"),
        ({"world": "hand", "robot": None, "camera": "realsense"}, "--camera"),
        ({"masks": "colour"}, "--masks: found colour, expected it goes with --camera only"),
        ({"camera": "sim"}, "--camera: found sim with --robot 10.0.0.1"),
        ({"camera": "realsense", "robot": "sim"}, "--camera: found realsense with --robot sim"),
        ({"camera": "realsense"}, "--camera-pose: found nothing, expected a file that says where the camera stands"),
    ],
)
def test_flags_that_contradict_each_other_are_refused(changes, message):
    with pytest.raises(InputError, match=message):
        dataclasses.replace(ARM, **changes).check()


def test_which_worlds_are_an_arm():
    assert ARM.check()
    assert dataclasses.replace(ARM, robot="sim", yes=True).check()
    assert dataclasses.replace(ARM, robot="sim", camera="sim").check()
    assert not dataclasses.replace(ARM, world="hand", robot=None).check()


def test_the_robot_is_found_by_its_name():
    assert robot_names() == ("franka",)
    assert ARM.given
    assert ARM.robot_of().__name__ == "coral.commands.franka_robot"


def test_a_robot_whose_wing_is_missing_is_one_line(monkeypatch):
    monkeypatch.setitem(plugins.OURS, "coral.robots", {"franka": "coral.no_such_wing.robot"})
    with pytest.raises(
        InputError, match=r"--world: found 'franka', expected the wing coral.no_such_wing, which is not"
    ):
        ARM.robot_of()

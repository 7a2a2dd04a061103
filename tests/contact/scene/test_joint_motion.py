"""Hinges and slides: poses by hand, and the simulation's own."""

import mujoco
import numpy as np
import pytest
from contact_bench import body, make_trial, plain

from coral.contact.control.hand_model import HandCfg
from coral.contact.control.planning_model import Index, build_model
from coral.contact.control.planning_world import put_state
from coral.contact.scene.joint_motion import joint_axis, joint_motion, joint_speed, move_joint
from coral.contact.scene.observation import BodyState, HandTarget, Observation
from coral.contact.scene.shapes import Joint
from coral.contact.worlds.hand_world import HandWorld

HINGE = {"kind": "hinge", "axis": [0, 0, 2], "point": [-0.03, 0, 0], "range": [0, 100], "start": 20, "friction": 0.01}
SLIDE = {"kind": "slide", "axis": [0, 1, 0], "range": [-0.2, 0.1], "friction": 1.0}


def trial_on(joint, **more):
    return make_trial(objects=[plain()["objects"][0] | {"z": 0.1, "yaw_deg": 90, "joint": joint} | more])


def test_a_hinge_turns_about_its_point():
    joint, start = Joint.model_validate(HINGE), body((0, 0, 0.1))
    moved = move_joint(joint, start, np.radians(90))
    assert moved.position == pytest.approx([-0.03, 0.03, 0.1])
    assert np.degrees(joint_motion(joint, start, moved)) == pytest.approx(90)
    spinning = BodyState(moved.position, moved.quaternion, np.zeros(3), np.array([0.5, 0, 0.7]))
    assert joint_speed(joint, start, spinning) == pytest.approx(0.7)


def test_a_slide_moves_along_its_axis_in_the_objects_frame():
    joint, start = Joint.model_validate(SLIDE), body((0, 0, 0.1), (0, 0, 90))
    assert joint_axis(joint, start) == pytest.approx([-1, 0, 0])
    moved = move_joint(joint, start, 0.05)
    assert moved.position == pytest.approx([-0.05, 0, 0.1])
    assert joint_motion(
        joint, start, BodyState(moved.position + np.array([0, 0.3, 0]), moved.quaternion)
    ) == pytest.approx(0.05)


@pytest.mark.parametrize("joint", [HINGE, SLIDE])
def test_the_simulation_moves_an_object_as_the_joint_does(joint):
    trial = trial_on(joint)
    world = HandWorld(trial)
    first = world.reset().objects["box"]
    assert first.position == pytest.approx(trial.objects["box"].pose.position, abs=1e-6)
    held = trial.task.object("box").joint
    by = 0.05
    world.data.joint("box_joint").qpos[0] += by
    mujoco.mj_forward(world.model, world.data)
    now = world.truth().objects["box"]
    expected = move_joint(held, trial.objects["box"].pose, by)
    assert now.position == pytest.approx(expected.position, abs=1e-6)
    assert abs(now.quaternion @ expected.quaternion) == pytest.approx(1)
    assert trial.joint_position("box", now) == pytest.approx(trial.objects["box"].joint_start + by)


@pytest.mark.parametrize("joint", [HINGE, SLIDE])
def test_rollouts_start_from_the_measured_joint(joint):
    trial = trial_on(joint)
    model = build_model(trial, HandCfg(), 0.01)
    data = mujoco.MjData(model)
    held, start = trial.task.object("box").joint, trial.objects["box"].pose
    seen = move_joint(held, start, 0.04)
    tool = BodyState(np.array([0, 0, 0.4]), np.array([0.0, 1, 0, 0]))
    put_state(model, data, Observation(0.0, tool, 0.08, np.zeros(6), {"box": seen}), trial)
    mujoco.mj_forward(model, data)
    assert data.body("box").xpos == pytest.approx(seen.position, abs=1e-6)
    index = Index(model, ["box"])
    assert data.sensordata[index.sensor["box/pos"]] == pytest.approx(seen.position, abs=1e-6)
    assert len(index.speeds) == 1


def test_a_drawer_stays_where_its_friction_holds_it_and_stops_at_the_end_of_its_range():
    steep = SLIDE | {"axis": [0, 0, 1], "range": [-0.05, 0.0]}
    for friction, down in ((3.0, 0.0), (0.5, -0.05)):  # the box weighs 2 N
        trial = trial_on(steep | {"friction": friction})
        world = HandWorld(trial)
        now = world.reset()
        hold = HandTarget(now.tool.position, now.tool.quaternion, 0.08, 600.0)
        for _ in range(40):
            now = world.step(hold)
        assert trial.joint_position("box", now.objects["box"]) == pytest.approx(down, abs=0.004)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"axis": [0, 0, 0]}, "an axis, not all zero"),
        ({"range": [0, 171]}, "within -170 to 170"),
        ({"range": [10, 10]}, "not empty"),
        ({"start": 101}, "a start within the range"),
        ({"kind": "slide", "range": [0, 0.1], "start": 0}, "a point only with a hinge"),
    ],
)
def test_refuses(change, expected):
    with pytest.raises(ValueError, match=expected):
        Joint.model_validate(HINGE | change)

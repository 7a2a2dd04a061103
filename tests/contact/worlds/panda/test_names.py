import numpy as np

from coral.contact.worlds.panda.names import (
    ARM_ACTUATORS,
    FINGER_ACTUATORS,
    FINGER_JOINTS,
    JOINTS,
    PAD_GEOMS,
    SITE,
    TOOL_IN_SITE,
    part_of,
)


def test_every_geom_has_a_name_for_the_camera(world):
    model = world.simulation.model
    names = {part_of(model, geom) for geom in range(model.ngeom)}
    assert names == {"hand", "left", "right", "robot", "table", "block", "box", "floor"}


def test_pads_belong_to_the_fingers(world):
    model = world.simulation.model
    parts = [part_of(model, model.geom(name).id) for name in PAD_GEOMS]
    assert parts == ["left", "left", "right", "right"]


def test_joints_and_actuators_are_those_of_the_arm_and_the_fingers(world):
    model = world.simulation.model
    for joint, actuator in zip((*JOINTS, *FINGER_JOINTS), (*ARM_ACTUATORS, *FINGER_ACTUATORS), strict=True):
        assert model.actuator(actuator).trnid[0] == model.joint(joint).id


def test_the_y_axis_of_the_tool_points_from_the_right_finger_to_the_left(world):
    model, data = world.simulation.model, world.simulation.data
    tool = data.site(SITE).xmat.reshape(3, 3) @ TOOL_IN_SITE
    left, right = (
        np.mean([data.geom(name).xpos for name in PAD_GEOMS if part_of(model, model.geom(name).id) == side], axis=0)
        for side in ("left", "right")
    )
    across = tool.T @ (left - right)
    assert across[1] > 0.05
    assert abs(across[[0, 2]]).max() < 1e-3
    np.testing.assert_allclose(np.linalg.det(TOOL_IN_SITE), 1.0)

import mujoco
import numpy as np
import pytest

from coral.contact.worlds.panda.environment import START_RAD
from coral.contact.worlds.panda.names import ARM_ACTUATORS, HAND_BODY, JOINTS, SITE
from coral.contact.worlds.panda.wrist_wrench import WristWrench

STEPS = 10


@pytest.fixture
def arm(panda):
    """The arm in its start posture, moving, with a wrist that has measured nothing yet."""
    model, data = panda.model, mujoco.MjData(panda.model)
    data.qpos[[model.joint(name).qposadr[0] for name in JOINTS]] = START_RAD
    data.qvel[[model.joint(name).dofadr[0] for name in JOINTS]] = [0.3, -0.2, 0.1, 0.4, 0.2, 0.2, -0.5]
    mujoco.mj_forward(model, data)
    return model, data, WristWrench(model, data)


def measured(model, data, wrist, apply=lambda: None):
    """The wrench over a control period in which the joints are driven unevenly."""
    wrist.begin()
    for k in range(STEPS):
        apply()
        data.ctrl[[model.actuator(name).id for name in ARM_ACTUATORS]] = [5.0, -20.0, 3.0, 10.0 - k, 2.0, 1.0, 0.5]
        mujoco.mj_step(model, data)
        wrist.add()
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    return wrist.wrench()


def test_weight_and_inertia_of_a_free_hand_are_not_felt(arm):
    model, data, wrist = arm
    before = data.qvel.copy()
    wrench = measured(model, data, wrist)
    assert np.abs(data.qvel - before).max() > 0.1
    np.testing.assert_allclose(wrench[:3], np.zeros(3), atol=0.05)
    np.testing.assert_allclose(wrench[3:], np.zeros(3), atol=0.01)


def test_a_force_on_the_hand_is_felt_in_world_axes_with_its_lever_from_the_tool(arm):
    model, data, wrist = arm
    hand, tool, force = model.body(HAND_BODY).id, model.site(SITE).id, np.array([1.0, -2.0, 3.0])
    levers = []

    def push():
        data.xfrc_applied[hand, :3] = force
        levers.append(data.xipos[hand] - data.site_xpos[tool])

    wrench = measured(model, data, wrist, push)
    np.testing.assert_allclose(wrench[:3], force, atol=0.05)
    np.testing.assert_allclose(wrench[3:], np.cross(np.mean(levers, axis=0), force), atol=0.02)


def test_each_period_is_measured_by_itself(arm):
    model, data, wrist = arm
    hand = model.body(HAND_BODY).id

    def push():
        data.xfrc_applied[hand, :3] = [0.0, 0.0, 10.0]

    assert measured(model, data, wrist, push)[2] == pytest.approx(10.0, abs=0.1)
    data.xfrc_applied[:] = 0.0
    assert measured(model, data, wrist)[2] == pytest.approx(0.0, abs=0.1)


def test_the_mass_is_that_of_the_hand_with_its_fingers(arm):
    model, _, wrist = arm
    names = [model.body(body).name for body in range(model.nbody)]
    inside = [body for body, name in enumerate(names) if name.startswith("gripper0_")]
    assert wrist.mass == pytest.approx(model.body_mass[inside].sum())

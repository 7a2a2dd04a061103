import mujoco
import numpy as np
import pytest

from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.scene.mujoco_scene import FINGER_FRICTION
from coral.contact.scene.observation import HandTarget
from coral.contact.worlds.panda.environment import (
    BASE_M,
    MOTOR_INERTIA_KG_M2,
    PHYSICS_DT_S,
    make_environment,
)
from coral.contact.worlds.panda.names import FINGER_ACTUATORS, FLOOR, JOINTS, PAD_GEOMS
from coral.errors import InputError


def test_the_arm_stands_where_it_is_configured_and_the_floor_below_its_pedestal(panda):
    panda.reset()
    data, base = panda.data, BASE_M
    np.testing.assert_allclose(data.body("robot0_link0").xpos, base, atol=1e-9)
    assert data.geom(FLOOR).xpos[2] == pytest.approx(base[2] - 0.912)


def test_the_physics_is_the_planners_with_robosuites_step(panda):
    option = panda.model.opt
    assert option.timestep == PHYSICS_DT_S
    assert option.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    assert option.disableflags & mujoco.mjtDisableBit.mjDSBL_AUTORESET


def test_a_step_takes_exactly_one_control_period(world):
    tool = world.reset().tool
    target = HandTarget(tool.position, tool.quaternion, 0.08, 600.0)
    times = [world.step(target).time_s for _ in range(3)]
    np.testing.assert_allclose(times, [0.02, 0.04, 0.06], atol=1e-12)


def test_fingers_squeeze_and_their_pads_grip_as_the_planner_believes(panda):
    for name in PAD_GEOMS:
        assert panda.model.geom(name).friction[0] == FINGER_FRICTION
    for name in FINGER_ACTUATORS:
        np.testing.assert_allclose(panda.model.actuator(name).ctrlrange, [-MAX_OPENING_M / 2, MAX_OPENING_M / 2])


def test_motors_have_the_configured_inertia(panda):
    for name in JOINTS:
        assert panda.model.joint(name).armature[0] == MOTOR_INERTIA_KG_M2


def test_nothing_stands_in_the_view_of_the_cameras(panda):
    names = [panda.model.geom(geom).name for geom in range(panda.model.ngeom)]
    assert not [name for name in names if name.startswith("wall_")]
    bodies = [panda.model.body(body).name for body in range(panda.model.nbody)]
    assert not {"left_eef_target", "right_eef_target"} & set(bodies)


def test_a_control_period_that_no_physics_step_divides_is_refused():
    with pytest.raises(InputError, match=r"physics_step_s.*a whole number of them in 0\.0125 s"):
        make_environment(lambda spec: None, 0.0125, lambda action: None)

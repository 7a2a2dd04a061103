"""The reduced model: its table, its sensors and the indices into its state."""

import mujoco
import numpy as np
import pytest
from contact_bench import make_trial, plain

from coral.contact.control.hand_model import FINGER_KG, HandCfg
from coral.contact.control.planning_model import SWING_RAD, Index, build_model, pair

TIN = {"name": "tin", "parts": [{"size": [0.04] * 3}], "mass_kg": 0.2, "friction": 0.5, "x": 0, "y": 0.2}
BOTH = make_trial(objects=[*plain()["objects"], TIN])
STEP_S = 0.005


@pytest.fixture(scope="module")
def model():
    return build_model(BOTH, HandCfg(), STEP_S)


def placed(model):
    """The objects where the trial has them, the hand far above."""
    data, index = mujoco.MjData(model), Index(model, ["box", "tin"])
    for name, where in index.pose.items():
        pose = BOTH.objects[name].pose
        data.qpos[where] = [*pose.position, *pose.quaternion]
    data.joint("hand_z").qpos = data.mocap_pos[0, 2] = 0.5
    return data, index


def test_an_endless_table_is_a_plane_of_the_same_height(model):
    assert model.geom("table").type == mujoco.mjtGeom.mjGEOM_BOX
    endless = build_model(BOTH, HandCfg(), STEP_S, endless=True).geom("table")
    assert endless.type == mujoco.mjtGeom.mjGEOM_PLANE
    assert endless.pos[2] == 0.0


def test_there_is_one_sensor_for_each_pair_that_may_touch(model):
    names = {model.sensor(k).name for k in range(model.nsensor)}
    hand = {f"{part}/{name}" for part in ("hand", "palm", "left", "right") for name in ("box", "tin")}
    hand |= {f"{part}/{name}" for part in ("hand", "palm") for name in ("table", "wall")}
    scene = {"box/table", "box/wall", "tin/table", "tin/wall", "box/tin"}
    assert {name for name in names if "/" in name} == hand | scene


def test_contacts_are_found_where_things_touch(model):
    data, index = placed(model)
    mujoco.mj_step(model, data, 10)
    touching = {name for name, where in index.sensor.items() if "/" in name and data.sensordata[where][0] > 0}
    assert touching == {pair("box", "table"), pair("tin", "table")}


def test_the_tool_is_measured_where_it_is(model):
    data, index = placed(model)
    data.joint("hand_x").qvel = 0.1
    mujoco.mj_forward(model, data)
    assert data.sensordata[index.sensor["ee_pos"]] == pytest.approx([0.0, 0.0, 0.5])
    assert data.sensordata[index.sensor["ee_vel"]] == pytest.approx([0.1, 0.0, 0.0])


def test_indices_lead_to_poses_and_speeds_in_the_state(model):
    data, index = placed(model)
    data.qvel[index.speed["tin"]] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    mujoco.mj_forward(model, data)
    assert data.body("tin").xpos == pytest.approx(BOTH.objects["tin"].pose.position)
    state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    assert state[index.speeds] == pytest.approx([0.0, 0.0, 0.0, 1.0, 2.0, 3.0])
    data.joint("left_slide").qpos, data.joint("right_slide").qpos = 0.01, 0.02
    assert data.qpos[[index.left, index.right]].tolist() == [0.01, 0.02]


@pytest.mark.parametrize("step_s", [0.002, 0.01])
def test_a_finger_on_its_spring_swings_slowly_enough_for_the_step(step_s):
    model = build_model(make_trial(), HandCfg(), step_s)
    armature = model.dof_armature[model.joint("left_slide").dofadr[0]]
    swing = np.sqrt(HandCfg().finger_stiffness_n_m / (FINGER_KG + armature)) * step_s
    assert swing == pytest.approx(SWING_RAD) if armature > 0 else swing <= SWING_RAD

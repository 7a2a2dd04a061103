"""The floating hand: its mass, its impedance and the bounds of its forces."""

import mujoco
import numpy as np
import pytest

from coral.contact.control.hand_model import HandCfg, add_hand, set_stiffness

CFG = HandCfg()


def hand(stiffness=600.0):
    """The hand alone, at its target, in gravity."""
    spec = mujoco.MjSpec()
    spec.option.timestep = 0.002
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    add_hand(spec, CFG)
    model = spec.compile()
    set_stiffness(model, CFG, stiffness)
    return model, mujoco.MjData(model)


def test_the_hand_shows_its_apparent_mass_and_needs_no_force_against_gravity():
    model, data = hand()
    assert model.body("hand").subtreemass.item() == pytest.approx(CFG.mass_kg)
    mujoco.mj_step(model, data, 100)
    assert data.site("tool").xpos == pytest.approx(np.zeros(3), abs=1e-4)


@pytest.mark.parametrize("stiffness", [200.0, 600.0])
def test_a_step_of_the_target_is_followed_without_overshoot(stiffness):
    model, data = hand(stiffness)
    data.mocap_pos[0] = [0.05, 0.0, 0.0]
    way = []
    for _ in range(600):
        mujoco.mj_step(model, data)
        way.append(data.joint("hand_x").qpos.item())
    omega = np.sqrt(stiffness / CFG.mass_kg)
    time_s = 0.002 * np.arange(1, 601)
    assert way == pytest.approx(0.05 * (1 - (1 + omega * time_s) * np.exp(-omega * time_s)), abs=1e-3)
    assert max(way) < 0.0501


def test_damping_is_a_share_of_the_critical_one_for_each_axis():
    model, _ = hand()
    set_stiffness(model, HandCfg(mass_kg=4.0, inertia_kg_m2=0.1, lever_m2=0.05, damping_ratio=0.7), 400.0)
    gains = [model.actuator(f"pull_{axis}").gainprm[0] for axis in (2, 3)]
    damping = [model.actuator(f"pull_{axis}").biasprm[2] for axis in (2, 3)]
    assert gains == [400.0, 20.0]
    assert damping == pytest.approx([-2 * 0.7 * np.sqrt(400.0 * 4.0), -2 * 0.7 * np.sqrt(20.0 * 0.1)])


def test_forces_and_torques_end_at_their_limits():
    model, data = hand()
    data.mocap_pos[0] = [1.0, -1.0, 0.0]
    data.mocap_quat[0] = [np.cos(0.7), np.sin(0.7), 0.0, 0.0]
    data.ctrl[:2] = -1.0
    mujoco.mj_forward(model, data)
    pull = np.array([data.actuator(f"pull_{axis}").force.item() for axis in range(6)])
    assert np.abs(pull[:3]).max() == pytest.approx(CFG.axis_force_limit_n)
    assert pull[3:] == pytest.approx([CFG.axis_torque_limit_n_m, 0.0, 0.0])
    assert data.actuator("left").force.item() == data.actuator("right").force.item() == -CFG.finger_force_n


def test_closed_fingers_meet_in_the_middle_and_touch_nothing_of_the_hand():
    model, data = hand()
    data.ctrl[:2] = 0.04
    mujoco.mj_step(model, data, 500)
    assert data.joint("left_slide").qpos.item() == pytest.approx(0.04, abs=1e-3)
    data.ctrl[:2] = 0.0
    mujoco.mj_step(model, data, 500)
    assert data.joint("right_slide").qpos.item() == pytest.approx(0.0, abs=1e-3)
    assert data.ncon == 0

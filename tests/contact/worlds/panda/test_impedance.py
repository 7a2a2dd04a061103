import dataclasses

import mujoco
import numpy as np
import pytest

from coral.contact.scene.geometry import from_rotvec, multiply
from coral.contact.scene.observation import HandTarget
from coral.contact.worlds.panda.environment import START_RAD
from coral.contact.worlds.panda.impedance import Impedance, ImpedanceCfg
from coral.contact.worlds.panda.names import ARM_ACTUATORS, FINGER_ACTUATORS, JOINTS, SITE, TOOL_IN_SITE


class Bench:
    """The arm at rest in its start posture, its torques computed but not stepped."""

    def __init__(self, panda, **cfg):
        self.model, self.data = panda.model, mujoco.MjData(panda.model)
        joints = np.array(START_RAD)
        self.qpos = [self.model.joint(name).qposadr[0] for name in JOINTS]
        self.dofs = [self.model.joint(name).dofadr[0] for name in JOINTS]
        self.arm = [self.model.actuator(name).id for name in ARM_ACTUATORS]
        self.data.qpos[self.qpos] = joints
        mujoco.mj_forward(self.model, self.data)
        self.impedance = Impedance(self.model, self.data, ImpedanceCfg(**cfg), joints)

    @property
    def here(self):
        """The target that the hand is at."""
        quaternion = np.zeros(4)
        tool = self.data.site(SITE).xmat.reshape(3, 3) @ TOOL_IN_SITE
        mujoco.mju_mat2Quat(quaternion, tool.ravel())
        return HandTarget(self.data.site(SITE).xpos.copy(), quaternion, 0.05, 400.0)

    def torques(self, **changes):
        """Beyond those that hold the arm against gravity, N m."""
        self.impedance.aim(dataclasses.replace(self.here, **changes))
        self.impedance.act()
        return self.data.ctrl[self.arm] - self.data.qfrc_bias[self.dofs]

    def wrench(self, **changes):
        """The wrench at the tool that these torques push with where nothing moves."""
        jacobian = np.zeros((6, self.model.nv))
        mujoco.mj_jacSite(self.model, self.data, jacobian[:3], jacobian[3:], self.model.site(SITE).id)
        return np.linalg.lstsq(jacobian[:, self.dofs].T, self.torques(**changes), rcond=None)[0]


@pytest.fixture
def bench(panda):
    return Bench(panda)


def test_the_error_is_the_way_to_the_target_and_the_turn_about_world_axes(bench):
    here = bench.here
    bench.impedance.aim(here)
    np.testing.assert_allclose(bench.impedance.error(here), np.zeros(6), atol=1e-9)
    turn = np.array([0.1, -0.2, 0.3])
    there = dataclasses.replace(
        here,
        position=here.position + np.array([0.01, 0.02, -0.03]),
        quaternion=multiply(from_rotvec(turn), here.quaternion),
    )
    bench.impedance.aim(there)
    np.testing.assert_allclose(bench.impedance.error(there), [0.01, 0.02, -0.03, *turn], atol=1e-9)


def test_at_its_target_the_arm_is_only_held_up(bench):
    np.testing.assert_allclose(bench.torques(), np.zeros(7), atol=1e-9)


def test_the_hand_is_pulled_with_stiffness_times_distance(bench):
    ahead = bench.here.position + np.array([0.02, 0.0, -0.01])
    np.testing.assert_allclose(bench.wrench(position=ahead), [8.0, 0.0, -4.0, 0.0, 0.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(
        bench.wrench(position=ahead, stiffness=200.0), [4.0, 0.0, -2.0, 0.0, 0.0, 0.0], atol=1e-6
    )


def test_a_turned_target_turns_the_hand_with_a_stiffness_that_scales_along(bench):
    turned = multiply(from_rotvec([0.0, 0.0, 0.1]), bench.here.quaternion)
    np.testing.assert_allclose(bench.wrench(quaternion=turned), [0.0, 0.0, 0.0, 0.0, 0.0, 0.05 * 400 * 0.1], atol=1e-6)


def test_a_commanded_force_is_added(bench):
    found = bench.wrench(force=np.array([0.0, 5.0, 0.0]))
    np.testing.assert_allclose(found, [0.0, 5.0, 0.0, 0.0, 0.0, 0.0], atol=1e-6)


def test_however_far_the_target_is_the_pull_is_limited(panda):
    weak = Bench(panda, max_force_n=20.0)
    far = weak.here.position + np.array([10.0, 0.0, 0.0])
    np.testing.assert_allclose(weak.wrench(position=far), [20.0, 0.0, 0.0, 0.0, 0.0, 0.0], atol=1e-6)


def test_torques_stay_within_those_of_the_motors(panda):
    strong = Bench(panda, max_force_n=1e4)
    strong.torques(position=strong.here.position + np.array([0.0, 0.0, -10.0]))
    limits = strong.model.actuator_ctrlrange[strong.arm, 1]
    assert (np.abs(strong.data.ctrl[strong.arm]) <= limits).all()
    assert (np.abs(strong.data.ctrl[strong.arm]) == limits).any()


def test_a_moving_hand_is_braked_against_its_motion(bench):
    bench.data.qvel[bench.dofs] = [0.3, -0.2, 0.1, 0.4, 0.0, 0.2, -0.1]
    mujoco.mj_forward(bench.model, bench.data)
    assert bench.torques() @ bench.data.qvel[bench.dofs] < -0.1


def test_the_posture_is_pulled_back_without_pushing_the_hand(panda):
    bench = Bench(panda)
    bench.data.qpos[bench.qpos] += [0.2, 0.1, -0.2, 0.1, 0.1, 0.0, 0.1]
    mujoco.mj_forward(bench.model, bench.data)
    torques = bench.torques()
    assert np.linalg.norm(torques) > 0.1
    # What accelerates the hand is J M^-1 tau.
    jacobian, mass = np.zeros((6, bench.model.nv)), np.zeros((bench.model.nv, bench.model.nv))
    mujoco.mj_jacSite(bench.model, bench.data, jacobian[:3], jacobian[3:], bench.model.site(SITE).id)
    mujoco.mj_fullM(bench.model, mass, bench.data.qM)
    acceleration = jacobian[:, bench.dofs] @ np.linalg.solve(mass[np.ix_(bench.dofs, bench.dofs)], torques)
    assert np.linalg.norm(acceleration) < 0.01


def test_fingers_are_commanded_half_the_opening_each(bench):
    bench.torques(opening_m=0.05)
    fingers = [bench.data.actuator(name).ctrl[0] for name in FINGER_ACTUATORS]
    np.testing.assert_allclose(fingers, [0.0255, -0.0255])


def test_without_a_target_nothing_is_commanded(bench):
    with pytest.raises(RuntimeError, match="aim before acting"):
        bench.impedance.act()

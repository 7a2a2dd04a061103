"""PyBullet's functions, answered from the state; their quaternions are (x, y, z, w)."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coral.contact.cost_program.pybullet import PyBullet
from coral.contact.cost_program.state import StateSpace
from coral.contact.cost_program.values import BodyHandle, Vec

A, B = (Rotation.from_euler("xyz", angles) for angles in ([0.3, -0.8, 1.9], [-2.0, 0.4, 0.1]))


@pytest.fixture
def p(meter, schema):
    bullet = PyBullet(StateSpace(schema))
    return lambda name, *args: bullet(meter, name, list(args), {})


def xyzw(rotation):
    return Vec(tuple(rotation.as_quat().tolist()), "xyzw")


def test_orientations_are_converted_as_by_scipy(p):
    np.testing.assert_allclose(p("getMatrixFromQuaternion", xyzw(A)).items, A.as_matrix().ravel())
    np.testing.assert_allclose(p("getEulerFromQuaternion", xyzw(A)).items, A.as_euler("xyz"))


def test_the_difference_of_orientations_turns_the_first_into_the_second(p):
    turn = Rotation.from_quat(p("getDifferenceQuaternion", xyzw(A), xyzw(B)).items)
    np.testing.assert_allclose((turn * A).as_matrix(), B.as_matrix())


def test_contact_is_answered_in_either_order_of_the_bodies(terms):
    found = terms("""
        return {"a": 1.0 * (len(p.getContactPoints(self.panda, self.box)) > 0),
                "b": 1.0 * (len(p.getContactPoints(bodyA=self.box, bodyB=self.robot_id, physicsClientId=self.cid)) > 0),
                "c": 1.0 * self.box_hand_contact}
    """)
    assert np.array_equal(found["a"], found["c"])
    assert np.array_equal(found["b"], found["c"])
    assert 0.0 < found["c"].mean() < 1.0


def test_poses_and_velocities_are_those_of_the_state(terms):
    found = terms("""
        pos, ori = p.getBasePositionAndOrientation(self.box)
        v, w = p.getBaseVelocity(self.box)
        hand = p.getLinkState(self.panda, self.grasp_link, computeLinkVelocity=1)
        return {"pos": dist(pos, self.box_pos), "ori": abs(ori[3] - self.box_quat[0]),
                "v": dist(v, self.box_vel), "w": dist(w, self.box_angvel),
                "hand": dist(hand[4], self.ee_pos), "spin": dist(hand[7], self.ee_angvel)}
    """)
    assert {name: np.abs(term).max() for name, term in found.items()} == dict.fromkeys(found, 0.0)


def test_what_pybullet_answers_can_be_changed_without_changing_the_state(agrees):
    agrees("""
        pos, ori = p.getBasePositionAndOrientation(self.box)
        pos = np.array(pos)
        pos[2] += 1.0
        return pos[2] + 10.0 * self.box_pos[2]
    """)


@pytest.mark.parametrize(
    ("call", "code", "words"),
    [
        ("p.getBaseVelocity(self.panda)[0][0]", "wrong_call", "self.board, self.box only"),
        ("p.getLinkState(self.box, 0)[0][0]", "wrong_call", "self.panda only"),
        ("p.getBaseVelocity(3)[0][0]", "wrong_call", "must be a body as self.object, not a number"),
        ("len(p.getContactPoints(self.panda))", "wrong_call", "for two bodies"),
        ("len(p.getContactPoints(self.table, self.wall))", "unknown_state", "contact of table and wall"),
        ("p.getEulerFromQuaternion(self.box_quat)[0]", "quaternion_order", "NAME_ori"),
        ("p.rotateVector(self.box_ori, self.ee_pos)[0]", "unknown_attribute", "no 'rotateVector'"),
        ("p.getEulerFromQuaternion(self.ee_pos)[0]", "wrong_size", "4 components, not 3"),
    ],
)
def test_arguments_that_pybullet_does_not_take_are_refused(call, code, words, refusal):
    found = refusal(f"return {call}")
    assert (found.code, words in found.text) == (code, True), found


def test_other_handles_are_no_bodies(p, meter):
    with pytest.raises(Exception, match="two bodies"):
        p("getContactPoints", BodyHandle("box"), BodyHandle("other"))

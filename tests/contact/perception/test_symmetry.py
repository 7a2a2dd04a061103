import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from solid_object import solid

from coral.contact.perception.symmetry import Symmetry, compare_poses, of_kind
from coral.contact.scene.geometry import from_rotvec, pose_matrix, rotation_about, rotation_angle, spread_rotations
from coral.contact.scene.observation import BodyState
from coral.errors import InputError

BOARD = (("box", (0.15, 0.1, 0.006)), ("box", (0.05, 0.045, 0.006), (0.2, 0.0, 0.0)))


@pytest.mark.parametrize(
    ("parts", "order", "continuous"),
    [
        ([("box", (0.05, 0.04, 0.03))], 4, False),
        ([("box", (0.04, 0.04, 0.03))], 8, False),
        ([("box", (0.03, 0.03, 0.03))], 24, False),
        (BOARD, 2, False),
        ([("cylinder", (0.03, 0.06))], 2, True),
        ([("cylinder", (0.03, 0.06)), ("cylinder", (0.01, 0.02), (0, 0, 0.07))], 1, True),
    ],
)
def test_the_group_of_a_shape(parts, order, continuous):
    symmetry = solid(*parts).symmetry
    assert len(symmetry.rotations) == order
    assert (symmetry.axis is not None) == continuous


def test_declared_groups_have_their_orders():
    orders = {
        kind: len(of_kind(kind, np.array([0.1, 0.1, 0.2])).rotations)
        for kind in ("none", "box", "square-box", "cube", "cylinder")
    }
    assert orders == {"none": 1, "box": 4, "square-box": 8, "cube": 24, "cylinder": 2}
    with pytest.raises(InputError, match="pyramid"):
        of_kind("pyramid", np.ones(3))


def test_a_mug_has_none(mug):
    assert len(mug.symmetry.rotations) == 1
    assert mug.symmetry.axis is None
    assert mug.diameter == pytest.approx(0.13, abs=0.005)


@given(st.integers(0, 99), st.integers(0, 99), st.sampled_from(["box", "square-box", "cube", "cylinder", "sphere"]))
@settings(max_examples=40, deadline=None)
def test_equal_poses_are_brought_to_the_same_one(k, j, kind):
    center = np.array([0.01, -0.02, 0.03])
    symmetry = of_kind(kind, np.array([0.1, 0.1, 0.2]), center)
    truth = pose_matrix(spread_rotations(100)[k], np.array([0.3, 0.1, 0.2]))
    members = symmetry.members(36)
    equal = truth @ members[j % len(members)]
    assert symmetry.difference(equal, truth) == (pytest.approx(0.0, abs=1e-9), pytest.approx(0.0, abs=1e-5))
    np.testing.assert_allclose(symmetry.nearest(equal, truth), truth, atol=1e-6)


def test_the_twist_of_a_can_is_taken_out_and_its_tilt_is_not():
    can = of_kind("cylinder", np.array([0.06, 0.06, 0.12]))
    tilted = pose_matrix(
        rotation_about(np.array([1.0, 0, 0]), 0.2) @ rotation_about(np.array([0, 0, 1.0]), 2.5), np.zeros(3)
    )
    _, turn = can.difference(tilted, np.eye(4))
    assert turn == pytest.approx(0.2, abs=1e-6)
    assert rotation_angle(can.nearest(tilted, np.eye(4))[:3, :3], np.eye(3)) == pytest.approx(0.2, abs=1e-6)


def test_the_error_of_a_pose_is_modulo_the_symmetry():
    true = BodyState(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    turned = BodyState(np.array([0.03, 0.04, 0.0]), from_rotvec([0.0, 0.0, np.pi - 0.1]))
    plain = compare_poses(Symmetry(), turned, true, lost=True)
    assert (plain.off_m, plain.off_rad, plain.lost) == (pytest.approx(0.05), pytest.approx(np.pi - 0.1), True)
    assert compare_poses(of_kind("box", np.ones(3)), turned, true, lost=False).off_rad == pytest.approx(0.1)

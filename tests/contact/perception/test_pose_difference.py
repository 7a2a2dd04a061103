import numpy as np
import pytest

from coral.contact.perception.pose_difference import compare_poses
from coral.contact.perception.symmetry import Symmetry, of_kind
from coral.contact.scene.geometry import from_rotvec
from coral.contact.scene.observation import BodyState

TRUE = BodyState(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


def test_the_error_is_modulo_the_symmetry():
    turned = BodyState(np.array([0.03, 0.04, 0.0]), from_rotvec([0.0, 0.0, np.pi - 0.1]))
    plain = compare_poses(Symmetry(), turned, TRUE, lost=True)
    assert (plain.off_m, plain.off_rad, plain.lost) == (pytest.approx(0.05), pytest.approx(np.pi - 0.1), True)
    assert compare_poses(of_kind("box", np.ones(3)), turned, TRUE, lost=False).off_rad == pytest.approx(0.1)

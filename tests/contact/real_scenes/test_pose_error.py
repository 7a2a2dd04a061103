import numpy as np
import pytest

from coral.contact.perception.symmetry import Symmetry, of_kind
from coral.contact.real_scenes.pose_error import add, add_s, mssd
from coral.contact.scene.geometry import rotation_about
from coral.contact.scene.rigid_transform import pose_matrix


def test_measures_of_a_shift():
    points = np.random.default_rng(0).uniform(-0.05, 0.05, (200, 3))
    moved = pose_matrix(np.eye(3), np.array([0.003, 0.004, 0.0]))
    assert add(moved, np.eye(4), points) == pytest.approx(0.005)
    assert mssd(moved, np.eye(4), points, Symmetry()) == pytest.approx(0.005)
    assert 0 < add_s(moved, np.eye(4), points) <= 0.005
    assert add_s(np.eye(4), np.eye(4), points) == 0.0


def test_measures_of_a_turned_ring():
    turn = 2 * np.pi * np.arange(360) / 360
    ring = np.stack([0.1 * np.cos(turn), 0.1 * np.sin(turn), 0 * turn], 1)
    turned = pose_matrix(rotation_about(np.array([0, 0, 1.0]), np.radians(30)), np.zeros(3))
    chord = 2 * 0.1 * np.sin(np.radians(15))
    assert add(turned, np.eye(4), ring) == pytest.approx(chord)
    assert mssd(turned, np.eye(4), ring, Symmetry()) == pytest.approx(chord)
    assert add_s(turned, np.eye(4), ring) == pytest.approx(0.0, abs=1e-9)
    assert mssd(turned, np.eye(4), ring, of_kind("cylinder", np.ones(3))) == pytest.approx(0.0, abs=1e-9)


def test_mssd_takes_the_largest_point_of_the_best_member():
    corners = np.array(np.meshgrid([-0.1, 0.1], [-0.05, 0.05], [-0.02, 0.02])).reshape(3, -1).T
    flipped = pose_matrix(rotation_about(np.array([0, 0, 1.0]), np.pi), np.array([0.0, 0.0, 0.01]))
    assert mssd(flipped, np.eye(4), corners, of_kind("box", np.ones(3))) == pytest.approx(0.01)
    assert mssd(flipped, np.eye(4), corners, Symmetry()) > 0.2

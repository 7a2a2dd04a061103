import numpy as np

from coral.contact.scene.geometry import from_rotvec, rotation_about
from coral.contact.scene.observation import BodyState
from coral.contact.scene.rigid_transform import body_to_matrix, inverse_transform, matrix_to_body, pose_matrix

QUARTER = rotation_about([0.0, 0.0, 1.0], np.pi / 2)


def test_a_pose_rotates_and_then_shifts():
    T = pose_matrix(QUARTER, [1.0, 2.0, 3.0])
    np.testing.assert_allclose(T @ [1.0, 0.0, 0.0, 1.0], [1.0, 3.0, 3.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(inverse_transform(T) @ [1.0, 3.0, 3.0, 1.0], [1.0, 0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(inverse_transform(T), np.linalg.inv(T), atol=1e-12)


def test_a_body_comes_back_from_its_matrix():
    body = BodyState(np.array([0.1, -0.2, 0.3]), from_rotvec([0.3, -0.4, 0.5]), np.ones(3), np.ones(3))
    T = body_to_matrix(body)
    back = matrix_to_body(T)
    np.testing.assert_allclose(back.position, body.position)
    np.testing.assert_allclose(back.quaternion, body.quaternion, atol=1e-12)
    assert not back.velocity.any()  # a pose says nothing of motion

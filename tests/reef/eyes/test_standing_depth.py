import numpy as np

from coral.reef.eyes.standing_depth import standing_depth

INF = np.inf


def test_floor_lies_on_the_plane_and_obstacles_stand_on_it():
    labels = np.array([[0, 2, 2], [3, 2, 0], [3, 1, 3]], np.uint8)
    ground = np.array([[INF] * 3, [4.0] * 3, [2.0] * 3], np.float32)
    expected = [[INF, 4.0, INF], [4.0, 4.0, INF], [2.0, 2.0, 2.0]]
    assert standing_depth(labels, ground).tolist() == expected


def test_each_obstacle_of_a_column_has_its_own_foot():
    labels = np.array([[2], [3], [2], [2]], np.uint8)
    ground = np.array([[8.0], [4.0], [3.0], [2.0]], np.float32)
    assert standing_depth(labels, ground).ravel().tolist() == [8.0, 4.0, 2.0, 2.0]

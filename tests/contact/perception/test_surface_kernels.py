import numpy as np

from coral.contact.perception.surface_kernels import distance

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) * 0.1
TETRA = CORNERS[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]


def test_distance_to_a_triangle_is_the_least_over_its_points():
    rng = np.random.default_rng(0)
    triangle, points = rng.normal(size=(1, 3, 3)), rng.normal(size=(30, 3))
    a, b = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 1, 201), np.linspace(0, 1, 201)))
    a, b = a[a + b <= 1], b[a + b <= 1]
    first, second = triangle[0, 1] - triangle[0, 0], triangle[0, 2] - triangle[0, 0]
    dense = triangle[0, 0] + a[:, None] * first + b[:, None] * second
    expected = np.linalg.norm(points[:, None] - dense, axis=2).min(1)
    np.testing.assert_allclose(distance(points, triangle), expected, atol=0.02)

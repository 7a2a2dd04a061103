import numpy as np

from coral.contact.perception.object_model import from_primitives
from coral.contact.perception.ray_solids import SolidPart
from coral.contact.perception.surface_kernels import distance
from coral.contact.real_scenes.mesh_reduction import reduce_mesh


def ball():
    return from_primitives("ball", [SolidPart("sphere", (0.05,) * 3)]).triangles


def test_a_small_mesh_stays_as_it_is():
    mesh = ball()
    assert reduce_mesh(mesh, len(mesh)) is mesh


def test_a_large_mesh_keeps_its_place_with_fewer_triangles():
    mesh = ball()
    few = reduce_mesh(mesh, 400)
    assert 150 < len(few) <= 400
    assert distance(np.ascontiguousarray(few.reshape(-1, 3)), mesh).max() < 0.003
    areas = np.linalg.norm(np.cross(few[:, 1] - few[:, 0], few[:, 2] - few[:, 0]), axis=1) / 2
    assert areas.min() > 0.0
    assert abs(areas.sum() / (4 * np.pi * 0.05**2) - 1) < 0.06


def test_triangles_still_face_outwards():
    few = reduce_mesh(ball(), 400)
    normals = np.cross(few[:, 1] - few[:, 0], few[:, 2] - few[:, 0])
    assert ((normals * few.mean(axis=1)).sum(axis=1) > 0).mean() > 0.99

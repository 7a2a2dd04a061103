"""A mug: hollow, with a handle, so without any symmetry."""

import itertools

import mujoco
import numpy as np
import pytest

from coral.contact.perception.object_model import from_body


def lathe(profile, sides=32):
    turn = 2 * np.pi * np.arange(sides) / sides
    rings = np.array([[[r * np.cos(a), r * np.sin(a), z] for a in turn] for r, z in profile])
    return strips(rings)


def strips(rings):
    faces = []
    for a, b in itertools.pairwise(rings):
        for k in range(len(a)):
            j = (k + 1) % len(a)
            faces += [[a[k], a[j], b[j]], [a[k], b[j], b[k]]]
    return faces


def mug_triangles(handle=True):
    faces = lathe([(0.0, -0.05), (0.04, -0.05), (0.04, 0.05), (0.036, 0.05), (0.036, -0.045), (0.0, -0.045)])
    if handle:
        rings = []
        for bend in np.linspace(-np.pi / 2, np.pi / 2, 9):
            out = np.array([np.cos(bend), 0.0, np.sin(bend)])
            middle = np.array([0.038, 0.0, 0.0]) + 0.03 * out
            rings.append(
                [
                    middle + 0.006 * (np.cos(t) * out + np.sin(t) * np.array([0.0, 1.0, 0.0]))
                    for t in 2 * np.pi * np.arange(8) / 8
                ]
            )
        faces += strips(np.array(rings))
    faces = np.array(faces)
    area = np.linalg.norm(np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]), axis=1)
    return faces[area > 1e-12]


@pytest.fixture(scope="session")
def mug():
    triangles = mug_triangles()
    faces = np.arange(3 * len(triangles)).reshape(-1, 3)
    spec = mujoco.MjSpec()
    spec.add_mesh(name="mug", uservert=triangles.ravel().tolist(), userface=faces.ravel().tolist())
    spec.worldbody.add_body(name="mug").add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="mug")
    return from_body(spec.compile(), "mug")

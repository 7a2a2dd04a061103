"""A mug: hollow, with a handle, so without any symmetry."""

import itertools

import numpy as np
import pytest


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
def mug_obj(tmp_path_factory):
    path = tmp_path_factory.mktemp("mesh") / "mug.obj"
    lines = []
    for k, triangle in enumerate(mug_triangles()):
        lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in triangle]
        lines.append(f"f {3 * k + 1} {3 * k + 2} {3 * k + 3}")
    path.write_text("\n".join(lines))
    return path

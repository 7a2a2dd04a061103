import struct

import mujoco
import numpy as np
import pytest

from coral.contact.perception.mesh_file import read_mesh
from coral.contact.perception.object_model import from_body, from_mesh, from_primitives
from coral.contact.perception.ray_solids import SolidPart
from coral.contact.perception.surface_kernels import distance
from coral.errors import InputError

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) * 0.1
TETRA = CORNERS[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]


def test_stl_and_obj_hold_the_same_triangles(tmp_path):
    binary = b"\0" * 80 + struct.pack("<I", 4)
    for t in TETRA:
        binary += struct.pack("<12fH", 0, 0, 0, *t.ravel(), 0)
    (tmp_path / "a.stl").write_bytes(binary)
    text = (
        "solid\n"
        + "".join(
            "facet normal 0 0 0\nouter loop\n"
            + "".join(f"vertex {x} {y} {z}\n" for x, y, z in t)
            + "endloop\nendfacet\n"
            for t in TETRA
        )
        + "endsolid\n"
    )
    (tmp_path / "b.stl").write_text(text)
    (tmp_path / "c.obj").write_text(
        "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nf 1 3 2\nf 1/1 2/1 4/1\nf 1 4 3\nf -3 -2 -1\n"
    )
    for name in ("a.stl", "b.stl", "c.obj"):
        np.testing.assert_allclose(read_mesh(tmp_path / name), TETRA, atol=1e-7)
    assert read_mesh(tmp_path / "a.stl", 0.5).max() == pytest.approx(0.05)


@pytest.mark.parametrize("content", [b"", b"v 0 0\nf 1 2 3\n", b"\xff\xfe\0\0"])
def test_a_broken_mesh_names_its_file(tmp_path, content):
    path = tmp_path / "bad.obj"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"bad\.obj"):
        read_mesh(path)


def test_millimetres_are_suspected(tmp_path):
    path = tmp_path / "mm.obj"
    path.write_text("v 0 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 3\n")
    with pytest.raises(InputError, match=r"0\.001 for mm"):
        from_mesh("thing", path)


def test_points_lie_on_the_surface_and_not_inside_another_part():
    model = from_primitives(
        "t", [SolidPart("box", (0.05, 0.04, 0.03)), SolidPart("cylinder", (0.02, 0.04), (0.0, 0.0, 0.04))]
    )
    inside = (np.abs(model.points) < np.array([0.05, 0.04, 0.03]) - 1e-6).all(1)
    assert not inside.any()
    assert distance(model.points, model.triangles).max() < 1e-9
    np.testing.assert_allclose(np.linalg.norm(model.normals, axis=1), 1.0)
    top = model.points[:, 2] > 0.08 - 1e-9
    np.testing.assert_allclose(model.normals[top], [[0, 0, 1]] * top.sum(), atol=1e-9)


@pytest.mark.parametrize(
    ("kind", "size", "area"),
    [
        ("sphere", (0.05,), 4 * np.pi * 0.05**2),
        ("capsule", (0.03, 0.05), 4 * np.pi * 0.03**2 + 2 * np.pi * 0.03 * 0.1),
        ("cylinder", (0.03, 0.05), 2 * np.pi * 0.03**2 + 2 * np.pi * 0.03 * 0.1),
        ("box", (0.1, 0.2, 0.3), 8 * 0.11),
    ],
)
def test_surfaces_have_their_area_and_face_outward(kind, size, area):
    t = from_primitives("t", [SolidPart(kind, size)]).triangles
    cross = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    assert np.linalg.norm(cross, axis=1).sum() / 2 == pytest.approx(area, rel=0.01)
    assert ((cross * t.mean(1)).sum(1) > 0).all()


def test_a_body_s_mesh_keeps_the_file_s_frame(mug_obj):
    scene = mujoco.MjModel.from_xml_string(
        f'<mujoco><asset><mesh name="m" file="{mug_obj}"/></asset><worldbody><body name="mug">'
        '<geom type="mesh" mesh="m"/></body></worldbody></mujoco>'
    )
    np.testing.assert_allclose(from_body(scene, "mug").pivot, from_mesh("mug", mug_obj).pivot, atol=1e-4)
    with pytest.raises(InputError, match="cup"):
        from_body(scene, "cup")


def test_distance_to_a_triangle_is_the_least_over_its_points():
    rng = np.random.default_rng(0)
    triangle, points = rng.normal(size=(1, 3, 3)), rng.normal(size=(30, 3))
    a, b = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 1, 201), np.linspace(0, 1, 201)))
    a, b = a[a + b <= 1], b[a + b <= 1]
    first, second = triangle[0, 1] - triangle[0, 0], triangle[0, 2] - triangle[0, 0]
    dense = triangle[0, 0] + a[:, None] * first + b[:, None] * second
    expected = np.linalg.norm(points[:, None] - dense, axis=2).min(1)
    np.testing.assert_allclose(distance(points, triangle), expected, atol=0.02)


@pytest.mark.parametrize("part", [("cone", (0.1, 0.1)), ("box", (0.1, 0.1)), ("sphere", (0.0,))])
def test_a_bad_part_is_refused(part):
    with pytest.raises(InputError, match="object"):
        SolidPart(*part)

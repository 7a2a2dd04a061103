import struct

import numpy as np
import pytest

from coral.contact.perception.mesh_file import read_mesh
from coral.errors import InputError

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) * 0.1
TETRA = CORNERS[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
VERTICES = "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\n"


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


def obj(tmp_path, text):
    path = tmp_path / "some.obj"
    path.write_text(text)
    return path


def test_a_face_of_many_corners_is_a_fan_of_triangles(tmp_path):
    square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
    found = read_mesh(obj(tmp_path, square))
    np.testing.assert_array_equal(found, [[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]])


@pytest.mark.parametrize(
    "face", ["f 1 2 5", "f 1 2 99999999999999999999", "f 1 2 0", "f -5 -2 -1", "f 0 1 2\nv 1 1 1\nv 2 2 2"]
)
def test_a_face_without_its_vertices_is_refused(tmp_path, face):
    with pytest.raises(InputError, match="broken mesh"):
        read_mesh(obj(tmp_path, f"{VERTICES}{face}\n"))


@pytest.mark.parametrize("text", [VERTICES, f"{VERTICES}v nan 0 0\nf 1 2 5\n"])
def test_without_finite_triangles_there_is_no_mesh(tmp_path, text):
    with pytest.raises(InputError, match="no finite triangles"):
        read_mesh(obj(tmp_path, text))


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"none\.stl.*a readable STL, OBJ or PLY file"):
        read_mesh(tmp_path / "none.stl")

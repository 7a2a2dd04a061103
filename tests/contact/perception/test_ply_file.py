import numpy as np
import pytest

from coral.contact.perception.ply_file import read_ply

CORNERS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 3.0)]
FACES = [(0, 1, 2), (0, 1, 3)]
HEAD = (
    "ply\nformat {form} 1.0\ncomment a comment\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
)


def text():
    rows = [f"{x} {y} {z} 7" for x, y, z in CORNERS] + [f"3 {a} {b} {c}" for a, b, c in FACES]
    return (HEAD.format(form="ascii") + "\n".join(rows) + "\n").encode()


def binary(order):
    row = [("x", order + "f4"), ("y", order + "f4"), ("z", order + "f4"), ("red", "u1")]
    vertices = np.array([(*corner, 7) for corner in CORNERS], row)
    faces = np.array([(3, face) for face in FACES], [("n", "u1"), ("i", order + "i4", 3)])
    form = "binary_little_endian" if order == "<" else "binary_big_endian"
    return HEAD.format(form=form).encode() + vertices.tobytes() + faces.tobytes()


@pytest.mark.parametrize("raw", [text(), binary("<"), binary(">")], ids=["text", "little", "big"])
def test_triangles_of_both_forms(raw):
    assert np.array_equal(read_ply(raw), np.array(CORNERS)[np.array(FACES)])


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"ply\n", b"plx\n"),
        (b"end_header", b"end"),
        (b"3 0 1 2", b"4 0 1 2"),
        (b"3 0 1 2", b"3 0 1 9"),
        (b"3 0 1 2", b"3 0 1 -1"),
        (b"element vertex 4", b"element edge 4"),
        (b"property float z", b"property float w"),
        (b"ascii", b"binary_middle_endian"),
        (b"1.0\ncomment a comment\nelement vertex 4", b"1.0 element vertex 4"),
        (b"1.0 0.0 0.0 7", b"one 0.0 0.0 7"),
    ],
)
def test_what_is_broken_is_refused(old, new):
    assert old in text()
    with pytest.raises((ValueError, KeyError, IndexError)):
        read_ply(text().replace(old, new))


def textured(counts=(6, 6)):
    """The binary file with a list of texture coordinates in each face, as MeshLab writes it."""
    row = [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("red", "u1")]
    vertices = np.array([(*corner, 7) for corner in CORNERS], row)
    kind = [("n", "u1"), ("i", "<i4", 3), ("m", "u1"), ("uv", "<f4", 6)]
    faces = np.array([(3, face, counts[k % 2], [0.5] * 6) for k, face in enumerate(FACES)], kind)
    head = HEAD.format(form="binary_little_endian").replace(
        "end_header", "property list uchar float texcoord\nend_header"
    )
    return head.encode() + vertices.tobytes() + faces.tobytes()


def test_texture_coordinates_are_passed_over():
    assert np.array_equal(read_ply(textured()), np.array(CORNERS)[np.array(FACES)])


def test_lists_of_several_lengths_are_refused():
    with pytest.raises(ValueError, match="a texcoord that differs from face to face"):
        read_ply(textured((6, 4)))
    with pytest.raises(ValueError, match="200 values of texcoord"):
        read_ply(textured((200, 6)))

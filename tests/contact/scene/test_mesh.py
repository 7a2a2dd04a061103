import numpy as np
import pytest
from contact_bench import stl

from coral.contact.scene.mesh import mesh_vertices
from coral.contact.scene.shapes import Shape
from coral.errors import InputError

CORNERS = np.array([(2.0, 0.0, 0.0), (3.0, 0.0, 0.0), (2.0, 2.0, 0.0), (2.0, 0.0, 4.0)])


def obj(path):
    lines = [f"v {x} {y} {z}" for x, y, z in CORNERS] + ["f 1 3 2", "f 1 2 4", "f 1 4 3", "f 2 3 4"]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def vertices(path, size=(1.0, 1.0, 1.0)):
    return mesh_vertices(Shape(shape="mesh", size=size, file=str(path)))


def as_set(points):
    return {tuple(np.round(point, 5).tolist()) for point in points}


def test_the_vertices_are_in_the_frame_of_the_file(tmp_path):
    for path in (stl(tmp_path / "part.stl", CORNERS), obj(tmp_path / "part.obj")):
        assert as_set(vertices(path)) == as_set(CORNERS)


def test_each_axis_has_its_own_scale(tmp_path):
    found = vertices(obj(tmp_path / "part.obj"), size=(0.1, 0.2, 0.05))
    assert as_set(found) == as_set(CORNERS * [0.1, 0.2, 0.05])


@pytest.mark.parametrize(("name", "content"), [("a.stl", b"solid nothing"), ("a.obj", b"v 0 0 0\n"), ("a.stl", None)])
def test_what_is_no_mesh_is_refused_by_the_name_of_its_file(tmp_path, name, content):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError) as refused:
        vertices(tmp_path / name)
    assert refused.value.where == str(tmp_path / name)
    assert refused.value.expected == "a binary STL or an OBJ mesh"
    assert "\n" not in str(refused.value)

import mujoco
import numpy as np
import pytest
from contact_bench import stl

from coral.contact.scene.mesh import add_mesh, mesh_vertices
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


def with_a_vertex_of_no_face(path):
    with obj(path).open("a", encoding="utf-8") as file:
        file.write("v 2.5 0.5 -3.0\n")
    return path


def test_a_vertex_of_no_face_is_no_part_of_the_mesh(tmp_path):
    path = with_a_vertex_of_no_face(tmp_path / "part.obj")
    assert as_set(vertices(path)) == as_set(CORNERS)
    for scale in (np.ones(3), np.array([0.1, 0.2, 0.05])):
        spec = mujoco.MjSpec()
        add_mesh(spec, "part", Shape(shape="mesh", size=(1.0, 1.0, 1.0), file=str(path)), scale)
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="part")
        model = spec.compile()
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, model.mesh_quat[0])
        assert as_set(model.mesh_vert @ turn.reshape(3, 3).T + model.mesh_pos[0]) == as_set(CORNERS * scale)


@pytest.mark.parametrize(("name", "content"), [("a.stl", b"solid nothing"), ("a.obj", b"v 0 0 0\n"), ("a.stl", None)])
def test_what_is_no_mesh_is_refused_by_the_name_of_its_file(tmp_path, name, content):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError) as refused:
        vertices(tmp_path / name)
    assert refused.value.where == str(tmp_path / name)
    assert refused.value.expected == "a binary STL or an OBJ mesh"
    assert "\n" not in str(refused.value)

import mujoco
import numpy as np
import pytest

from coral.contact.plan.convex_pieces import box, pieces
from coral.contact.scene.geometry import rotation_of
from coral.contact.scene.mujoco_scene import add_scene
from coral.contact.scene.task import Task
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task

UP, SIDE = np.array([0.0, 0, 1]), np.array([1.0, 0, 0])


def solid(tmp_path, **part):
    """The only piece of an object that consists of one part."""
    task = Task.model_validate(
        {
            "name": "new",
            "title": "New",
            "instruction": "Do it.",
            "time_limit_s": 20,
            "objects": [{"name": "thing", "parts": [part], "mass_kg": 0.2, "friction": 0.5, "x": 0, "y": 0}],
            "success": {"conditions": [{"kind": "lifted", "object": "thing", "height_m": 0.1}]},
        }
    )
    return pieces(sample_trial(task, 0), "thing")[0]


def leaves(one, point, way):
    rise, normal = one.leave(np.array([point], dtype=float), way)
    return rise[0], normal[0]


@pytest.mark.parametrize(
    ("part", "point", "way", "rise", "normal"),
    [
        ({"shape": "box", "size": [0.2, 0.1, 0.06]}, (0.05, 0, 0.1), UP, -0.07, UP),
        ({"shape": "box", "size": [0.2, 0.1, 0.06], "rpy_deg": [0, 90, 0]}, (0, 0, 0), UP, 0.1, UP),
        ({"shape": "cylinder", "size": [0.1, 0.1, 0.2]}, (0, 0.03, 0), SIDE, 0.04, np.array([0.8, 0.6, 0])),
        ({"shape": "cylinder", "size": [0.1, 0.1, 0.2]}, (0, 0.03, 0), UP, 0.1, UP),
        (
            {"shape": "sphere", "size": [0.1, 0.1, 0.1], "position": [0, 0, 0.2]},
            (0.03, 0, 0),
            UP,
            0.24,
            np.array([0.6, 0, 0.8]),
        ),
    ],
)
def test_lines_leave_each_shape_where_geometry_says(tmp_path, part, point, way, rise, normal):
    found, facing = leaves(solid(tmp_path, **part), point, way)
    assert found == pytest.approx(rise)
    assert np.allclose(facing, normal, atol=1e-9)


def test_of_a_mesh_the_hull_counts(tmp_path):
    # two ramps with a notch between: what touches is the hull, which is flat on top
    corners = [
        (0, 0, 0),
        (0.1, 0, 0),
        (0.1, 0.1, 0),
        (0, 0.1, 0),
        (0, 0, 0.1),
        (0.1, 0, 0.1),
        (0.1, 0.1, 0.1),
        (0, 0.1, 0.1),
        (0.05, 0.05, 0.02),
    ]
    faces = [
        (0, 2, 1),
        (0, 3, 2),
        (0, 1, 5),
        (0, 5, 4),
        (1, 2, 6),
        (1, 6, 5),
        (2, 3, 7),
        (2, 7, 6),
        (3, 0, 4),
        (3, 4, 7),
        (4, 5, 8),
        (5, 6, 8),
        (6, 7, 8),
        (7, 4, 8),
    ]
    path = tmp_path / "notched.obj"
    path.write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
        + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)
    )
    one = solid(tmp_path, shape="mesh", size=[1, 1, 1], file=str(path))
    found, facing = leaves(one, (0.05, 0.05, 0.02), UP)
    assert found == pytest.approx(0.08, abs=1e-5)
    assert np.allclose(facing, UP, atol=1e-5)
    assert one.depth(np.array([[0.05, 0.05, 0.05], [0.05, 0.05, 0.13]])) == pytest.approx([0.05, -0.03], abs=1e-5)


def test_a_line_that_misses_leaves_nowhere():
    assert np.isnan(leaves(box(np.full(3, 0.1)), (0.06, 0, 0), UP)[0])
    assert not np.isnan(leaves(box(np.full(3, 0.1)), (0.04, 0, 0), UP)[0])


@pytest.mark.parametrize("name", ["can", "carton"])
def test_lines_leave_where_a_ray_of_mujoco_comes_in(name):
    trial = sample_trial(load_task("pick-clutter"), 4)
    spec = mujoco.MjSpec()
    add_scene(spec, trial)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    geom = model.geom(f"{name}/0").id
    model.geom_group[:] = 3
    model.geom_group[geom] = 0
    only = np.array([1, 0, 0, 0, 0, 0], dtype=np.uint8)
    pose, one, rng = trial.objects[name].pose, pieces(trial, name)[0], np.random.default_rng(0)
    turn = rotation_of(pose.quaternion)
    for _ in range(200):
        way = rng.normal(size=3)
        way /= np.linalg.norm(way)
        point = rng.uniform(-0.06, 0.06, 3)
        start, hit = pose.position + turn @ (point + way), np.zeros(1, dtype=np.int32)
        found = mujoco.mj_ray(model, data, start, -(turn @ way), only, 1, -1, hit)
        rise, _ = leaves(one, point, way)
        assert np.isnan(rise) if found < 0 else rise == pytest.approx(1.0 - found, abs=1e-6)

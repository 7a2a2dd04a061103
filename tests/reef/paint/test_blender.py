"""Running Blender: the interpreter that has it, failures in one line, and what comes back."""

import stat
import sys

import numpy as np
import pytest

from coral.errors import InputError, RunError
from coral.reef.paint import blender
from coral.reef.paint.blender_scene import CyclesCfg, describe_scene, describe_view
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Label, Pose
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import find_water
from coral.reef.world.world import load_world

CAMERA, HERE = CameraCfg(width=80, height=60), Pose(6.0, 5.3, 0.0)
SCENE = Scene.from_world(load_world("s1"))


def job():
    described = describe_scene(SCENE, CAMERA, find_water("clear"), PainterCfg(), CyclesCfg(samples=1), seed=1)
    described["views"] = [describe_view("a", HERE, CAMERA, SCENE, 0)]
    return described


def program(tmp_path, text):
    """A program in the place of Blender's Python: it is given -W, ignore, the script and the job."""
    path = tmp_path / "python"
    path.write_text(
        f"#!{sys.executable}\nimport json, os, sys\nimport numpy as np\njob = json.load(open(sys.argv[-1]))\n{text}"
    )
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def test_without_bpy_the_user_is_told_how_to_get_it(monkeypatch, tmp_path):
    monkeypatch.delenv(blender.VARIABLE, raising=False)
    monkeypatch.setattr(blender.importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    assert blender.blender_python() is None
    with pytest.raises(InputError, match="make setup-blender"):
        blender.find_python()


def test_a_variable_names_the_interpreter(monkeypatch, tmp_path):
    monkeypatch.setenv(blender.VARIABLE, str(tmp_path / "nothing"))
    with pytest.raises(InputError, match=blender.VARIABLE):
        blender.find_python()
    monkeypatch.setenv(blender.VARIABLE, sys.executable)
    assert blender.find_python() == sys.executable


def test_a_failure_of_blender_is_told_in_one_line(monkeypatch, tmp_path):
    monkeypatch.setenv(blender.VARIABLE, program(tmp_path, "print('no room'); sys.exit(3)"))
    with pytest.raises(RunError, match=r"exit code 3\): no room"):
        list(blender.render_views(job(), SCENE, CAMERA, PainterCfg()))


def test_what_blender_measured_becomes_a_frame(monkeypatch, tmp_path):
    """A floor 2 m ahead on the left, nothing in the middle, the first solid on the right but too far away."""
    text = """
index = np.zeros((60, 80), np.int32)
index[:, :30], index[:, 50:] = 1, 2
depth = np.full((60, 80), 2.0, np.float32)
depth[:, 50:] = 20.0
np.savez(os.path.join(job["folder"], "a.npz"), light=np.full((60, 80, 3), 0.1), depth=depth, index=index)
assert job["caustics"]["most"] > 1.0 and os.path.exists(job["caustics"]["path"])
print(json.dumps({"rendered": "a"}))
"""
    monkeypatch.setenv(blender.VARIABLE, program(tmp_path, text))
    told = []
    ((name, frame),) = blender.render_views(job(), SCENE, CAMERA, PainterCfg(), told=told.append)
    assert (name, told) == ("a", ["a"])
    assert (frame.labels[:, :30] == Label.SEABED).all()
    assert (frame.labels[:, 30:] == Label.WATER).all()
    assert (frame.depth[:, :30] == 2.0).all()
    assert np.isinf(frame.depth[:, 30:]).all()
    assert frame.rgb.shape == (60, 80, 3)


@pytest.mark.blender
def test_blender_and_our_camera_see_the_same_geometry():
    if blender.blender_python() is None:
        pytest.skip("no bpy: make setup-blender")
    ((_, seen),) = blender.render_views(job(), SCENE, CAMERA, PainterCfg())
    ours = Camera(SCENE, CAMERA).render(HERE)
    assert (seen.labels == ours.labels).mean() > 0.995
    same = (seen.instances == ours.instances) & np.isfinite(ours.depth) & np.isfinite(seen.depth)
    assert np.median(np.abs(seen.depth - ours.depth)[same]) < 1e-3
    assert seen.rgb.std() > 5.0

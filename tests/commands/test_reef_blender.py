"""`coral reef blender`: refused in time, and what it leaves."""

import sys

import numpy as np
import pytest

from coral.reef.paint import blender
from coral.reef.paint.picture_set import read_pictures
from coral.reef.world.geometry import Frame


@pytest.fixture
def rendering(monkeypatch):
    """Blender's place is taken by gray pictures; what it was asked is kept."""
    jobs = []

    def render(job, scene, camera, cfg, *, told, **_):
        jobs.append(job)
        shape = (camera.height, camera.width)
        for view in job["views"]:
            told(view["name"])
            yield view["name"], Frame(
                np.ones(shape, np.float32), np.full(shape, 3, np.uint8), np.full(shape, -1, np.int32),
                np.full((*shape, 3), 90, np.uint8),
            )  # fmt: skip

    monkeypatch.setattr(blender, "render_views", render)
    monkeypatch.setattr(blender, "find_python", lambda: sys.executable)
    return jobs


def test_pictures_are_written_beside_the_scene(told, tmp_path, rendering):
    out = tmp_path / "reef.blend"
    code, result, _ = told("reef", "blender", "s1", "--out", out, "--render", "3", "--water", "3C", "--json")
    assert code == 0
    assert result == {"blend": str(out), "pictures": 3, "folder": str(tmp_path / "reef"), "water": "jerlov-3C"}
    (job,) = rendering
    assert job["blend"] == str(out)
    assert job["water"]["name"] == "jerlov-3C"
    pictures = list(read_pictures(tmp_path / "reef"))
    assert [about.name for about, _ in pictures] == ["0000", "0001", "0002"]
    assert pictures[0][1].rgb.shape == (240, 320, 3)


@pytest.mark.parametrize(
    ("flags", "named"),
    [
        (["--out", "reef.png"], "ends in .blend"),
        (["--out", "reef.blend", "--water", "tap"], "--water"),
        (["--out", "reef.blend", "--render", "-1"], "--render"),
    ],
)
def test_bad_flags_are_named(told, tmp_path, monkeypatch, rendering, flags, named):
    monkeypatch.chdir(tmp_path)
    code, _, error = told("reef", "blender", "s1", *flags)
    assert code == 2
    assert named in error
    assert rendering == []


def test_nothing_is_overwritten(told, tmp_path, rendering):
    out = tmp_path / "reef.blend"
    out.write_text("mine")
    code, _, error = told("reef", "blender", "s1", "--out", out)
    assert code == 2
    assert "exists" in error
    assert out.read_text() == "mine"

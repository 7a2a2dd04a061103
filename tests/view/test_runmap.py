import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.pictures.mapview import draw_map
from coral.view.run import RunFolder
from coral.view.runmap import scene_at, snapshot, step_at, write_map


def test_the_scene_shows_only_what_was_known_then(finished):
    run = RunFolder.read(finished)
    early, late = scene_at(run, 10.0), scene_at(run, 40.0)
    assert early.pose.x == pytest.approx(3.8, abs=0.01)
    assert len(early.trajectory) == 101
    assert (early.cells > 0).sum() < (late.cells > 0).sum()
    assert early.cells.shape == (240, 240)
    assert early.cell_m == pytest.approx(0.05)
    assert late.goal == (9.0, 9.0)
    assert list(late.visited) == [True, False]


def test_the_final_map_is_written(fresh):
    image = cv2.imread(str(write_map(RunFolder.read(fresh))))
    assert max(image.shape[:2]) <= 768
    green = (np.abs(image.astype(int) - (76, 166, 38)) < 5).all(axis=2).sum()
    assert green > 500


def test_a_snapshot_is_the_last_one_that_is_no_later(finished):
    run = RunFolder.read(finished)
    assert [step_at(run, t) for t in (0.0, 1.9, 2.0, 39.0, 1e9)] == [0, 0, 20, 380, 400]
    np.testing.assert_array_equal(snapshot(run, 3.9), run.frame(20, "map"))
    assert step_at(replace(run, frame_steps=()), 5.0) is None
    assert snapshot(replace(run, frame_steps=()), 5.0) is None


def test_a_heading_is_interpolated_the_short_way_round(finished):
    run = RunFolder.read(finished)
    columns = {name: np.zeros(2) for name in ("step", "x", "y", "goal_x", "goal_y")}
    turning = replace(run, trajectory={**columns, "t": np.array([0.0, 1.0]), "theta": np.array([3.0, -3.0])})
    assert abs(scene_at(turning, 0.5).pose.theta) == pytest.approx(math.pi, abs=1e-6)


def test_a_run_without_anything_has_an_empty_map(fresh):
    for path in fresh.iterdir():
        if path.is_file() and path.name != "events.jsonl":
            path.unlink()
    (fresh / "events.jsonl").write_text("")
    run = replace(RunFolder.read(fresh), frame_steps=())
    scene = scene_at(run, 5.0)
    assert (scene.pose, scene.goal, scene.cells.any()) == (None, None, False)


def test_a_map_that_cannot_be_written_is_one_line(fresh):
    (fresh / "map.png").unlink(missing_ok=True)
    (fresh / "map.png").mkdir()
    with pytest.raises(InputError, match=r"map\.png: found .*, expected a file that can be written"):
        write_map(RunFolder.read(fresh))


def test_the_map_says_what_things_were_taken_for(fresh):
    run = RunFolder.read(fresh)
    said = [{"dot": 1, "x": 9.0, "y": 9.0, "label": "tyre", "skip": True, "why": ""}]
    run = replace(run, events=[*run.events, {"event": "goal", "t": 12.0, "said": said}])
    early, late = (scene_at(run, t) for t in (10.0, 40.0))
    assert (early.marks, late.marks) == ([], [(9.0, 9.0, "tyre, ruled out")])
    assert (draw_map(late).rgb != draw_map(replace(late, marks=())).rgb).any()

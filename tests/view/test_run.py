import json

import cv2
import numpy as np
import pytest

from coral.errors import InputError
from coral.view.decisions import decisions
from coral.view.run import RunFolder, read_camera_frame


def test_a_finished_run_is_read_whole(finished):
    run = RunFolder.read(finished)
    assert run.complete
    assert run.notes == ()
    assert run.duration_s == 40.0
    assert len(run.column("x")) == 400
    assert np.isnan(run.column("goal_x")[0])
    assert run.column("goal_x")[-1] == 9.0
    assert np.isnan(run.column("not-a-column")).all()
    assert run.frame_steps == tuple(range(0, 401, 20))
    assert run.frame(400, "map").shape == (240, 240)
    assert run.frame(400, "depth").dtype == np.uint16
    assert run.world["size_m"] == [12.0, 12.0]
    assert run.picture("00map").is_file()


def test_a_picture_is_never_looked_up_outside_the_run(finished):
    assert RunFolder.read(finished).picture("../pictures/00map") is None


def test_a_killed_run_gives_all_but_the_cut_lines(killed, finished):
    run, whole = RunFolder.read(killed), RunFolder.read(finished)
    assert not run.complete
    assert run.events == whole.events[:-1]
    assert len(run.column("t")) == len(whole.column("t")) - 1
    for name in ("events.jsonl", "trajectory.csv", "metrics.json", "timing.json"):
        assert any(name in note for note in run.notes), name


def test_every_cut_is_survived(fresh):
    text = (fresh / "events.jsonl").read_text()[:700]
    rows = (fresh / "trajectory.csv").read_text()[:400]
    for cut in range(0, 700, 7):
        (fresh / "events.jsonl").write_text(text[:cut])
        (fresh / "trajectory.csv").write_text(rows[: cut // 2])
        run = RunFolder.read(fresh)
        assert len(run.events) <= text[:cut].count("\n") + 1
        assert len(run.column("t")) <= max(0, rows[: cut // 2].count("\n") - 1)
        decisions(run)


def test_lines_that_are_no_events_are_left_out_and_noted(fresh):
    lines = (fresh / "events.jsonl").read_text().splitlines()
    (fresh / "events.jsonl").write_text("\n".join([lines[0], "[]", "{", json.dumps({"t": 1}), lines[1]]) + "\n")
    run = RunFolder.read(fresh)
    assert [event["event"] for event in run.events] == ["start", "trigger"]
    assert len(run.notes) == 3


def test_not_a_run(tmp_path):
    (tmp_path / "empty").mkdir()
    (tmp_path / "file").write_text("")
    for name in ("missing", "empty", "file"):
        with pytest.raises(InputError, match=name):
            RunFolder.read(tmp_path / name)


def test_what_the_camera_saw_is_read_with_colours_where_they_were_kept(fresh):
    run = RunFolder.read(fresh)
    assert read_camera_frame(run.path, 400).rgb is None
    assert read_camera_frame(run.path, 399) is None
    labels = run.frame(400, "labels")
    rgb = np.zeros((*labels.shape, 3), np.uint8)
    rgb[..., 0] = 200
    cv2.imwrite(str(fresh / "frames" / "000400_rgb.jpg"), rgb[..., ::-1])
    seen = read_camera_frame(run.path, 400)
    assert np.abs(seen.rgb.astype(int) - rgb).max() <= 2
    assert np.array_equal(seen.labels, np.minimum(labels, 3))
    cv2.imwrite(str(fresh / "frames" / "000400_rgb.jpg"), rgb[..., 0])
    assert read_camera_frame(run.path, 400).rgb is None


def test_a_table_without_a_header_is_left_out(fresh):
    (fresh / "trajectory.csv").write_text("\n1,2,3\n")
    run = RunFolder.read(fresh)
    assert run.trajectory == {}
    assert "trajectory.csv begins with an empty line instead of a header and was left out." in run.notes


def test_numbers_that_no_mission_reaches_are_left_out_of_tables(fresh):
    table = fresh / "trajectory.csv"
    head, first, *rest = table.read_text().splitlines()
    fields = first.split(",")
    fields[head.split(",").index("x")] = "1e300"
    fields[head.split(",").index("y")] = "inf"
    table.write_text("\n".join([head, ",".join(fields), *rest]) + "\n")
    run = RunFolder.read(fresh)
    assert np.isnan(run.column("x")[0])
    assert np.isnan(run.column("y")[0])
    assert np.isfinite(run.column("x")[1])


@pytest.mark.parametrize("odd", ["1e300", "nan", ""])
def test_a_row_without_a_time_is_left_out(fresh, odd):
    table = fresh / "trajectory.csv"
    head, *rows = table.read_text().splitlines()
    fields = rows[-1].split(",")
    fields[head.split(",").index("t")] = odd
    table.write_text("\n".join([head, *rows, ",".join(fields)]) + "\n")
    run = RunFolder.read(fresh)
    assert len(run.column("t")) == len(rows)
    assert "trajectory.csv: 1 line without a time left out." in run.notes
    assert np.isfinite(run.duration_s)

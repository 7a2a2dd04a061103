"""Recordings for rerun, where it is installed."""

import importlib.util
import sys

import cv2
import numpy as np
import pytest
from survey_runs import write_run

from coral.errors import InputError
from coral.reef.recordings.rerun_export import write_rerun
from coral.reef.recordings.run_recording import read_run
from coral.reef.recordings.transforms import body_transform

HAS_RERUN = importlib.util.find_spec("rerun") is not None


def test_without_rerun_the_error_says_what_else_there_is(survey_run, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(InputError, match=r"coral-robotics\[rerun\].*--to mcap"):
        write_rerun(read_run(survey_run).located(), tmp_path / "x.rrd")


@pytest.mark.skipif(not HAS_RERUN, reason="rerun is not installed (make test-rerun)")
def test_rerun_reads_back_every_pose_and_picture(tmp_path):
    from rerun.chunk import RrdReader

    write_run(tmp_path / "patch-001", colour=True)
    recording = read_run(tmp_path / "patch-001").located()
    counts = write_rerun(recording, tmp_path / "out/x.rrd")
    assert counts["keyframes"] == 41
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["x.rrd"]
    rows = {}
    for chunk in RrdReader(tmp_path / "out/x.rrd").stream():
        rows.setdefault(chunk.entity_path, []).extend(chunk.to_record_batch().to_pylist())
    keyframes = list(recording.keyframes())
    for path in ("/world/robot", *(f"/world/robot/camera/image/{name}" for name in ("colour", "classes", "depth"))):
        rows[path].sort(key=lambda row: row["t"])
        assert len(rows[path]) == 41
    k = 17
    at = body_transform(keyframes[k].pose, keyframes[k].height_m, 0.0, 0.0)
    moved = rows["/world/robot"][k]
    np.testing.assert_allclose(moved["Transform3D:translation"][0], at[:3, 3], atol=1e-6)
    np.testing.assert_allclose(np.reshape(moved["Transform3D:mat3x3"][0], (3, 3)).T, at[:3, :3], atol=1e-6)
    classes = np.array(rows["/world/robot/camera/image/classes"][k]["SegmentationImage:buffer"][0], np.uint8)
    np.testing.assert_array_equal(classes.reshape(60, 80), keyframes[k].frame.labels)
    jpeg = bytes(rows["/world/robot/camera/image/colour"][k]["EncodedImage:blob"][0])
    assert (
        np.abs(cv2.imdecode(np.frombuffer(jpeg, np.uint8), 1)[:, :, ::-1] - keyframes[k].frame.rgb.astype(int)).mean()
        < 3
    )
    assert len(rows["/world/oysters"]) == counts["maps"]
    assert "log_time" not in moved

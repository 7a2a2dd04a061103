"""The pictures that a run folder keeps."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from coral.reef.mission.record import COLUMNS, POSE_COLUMNS, FrameRecorder, PicturePose, RecordCfg
from coral.reef.world.geometry import Frame, Label, Pose
from coral.runs import RunWriter

DEPTH = np.array([[0.25, 1.5], [100.0, np.inf]], np.float32)
LABELS = np.array([[Label.OYSTER, Label.SEABED], [Label.OBSTACLE, Label.WATER]], np.uint8)
FRAME = Frame(depth=DEPTH, labels=LABELS, instances=np.full((2, 2), -1, np.int32))
CELLS = np.array([[0, 1, 2, 3]], np.uint8)


@pytest.fixture
def writer(tmp_path):
    made = RunWriter(tmp_path / "run", COLUMNS)
    yield made
    made.close()


def kept(writer):
    return sorted(path.name for path in (writer.folder / "frames").glob("*.png"))


def test_pictures_are_read_as_they_were(writer):
    recorder = FrameRecorder(writer, RecordCfg())
    recorder.offer(7, 0.7, lambda: CELLS, FRAME)
    recorder.close()
    read = {
        name: cv2.imread(str(writer.folder / "frames" / f"000007_{name}.png"), cv2.IMREAD_UNCHANGED)
        for name in ("map", "depth", "labels")
    }
    np.testing.assert_array_equal(read["map"], CELLS)
    np.testing.assert_array_equal(read["labels"], LABELS)
    # Millimetres; what is too far for 16 bits is as far as they reach, and nothing seen is 0.
    np.testing.assert_array_equal(read["depth"], [[250, 1500], [65535, 0]])
    assert read["depth"].dtype == np.uint16


def test_a_set_is_kept_once_a_period(writer):
    recorder = FrameRecorder(writer, RecordCfg(frame_period_s=0.3))
    for step in range(11):
        recorder.offer(step, step * 0.1, lambda: CELLS, FRAME)
    recorder.close()
    assert kept(writer) == [f"{step:06d}_{n}.png" for step in (0, 3, 6, 9) for n in ("depth", "labels", "map")]


def test_without_frames_the_final_map_alone_is_kept(writer):
    recorder = FrameRecorder(writer, RecordCfg(frames=False))
    recorder.offer(0, 0.0, lambda: CELLS, FRAME)
    recorder.keep_final_map(9, lambda: CELLS)
    recorder.close()
    assert kept(writer) == ["000009_map.png"]


def test_a_full_disk_is_told_at_the_next_set():
    class FullDisk:
        def bytes(self, name, content):
            raise OSError("no space left")

    recorder = FrameRecorder(FullDisk(), RecordCfg(frame_period_s=1.0))
    recorder.offer(0, 0.0, lambda: CELLS, FRAME)
    with pytest.raises(OSError, match="no space left"):
        recorder.close()


AT = PicturePose(pose=Pose(1.0, 2.0, 0.5), odometry=Pose(1.1, 2.0, 0.5), height_m=1.2, roll=0.01, pitch=-0.02)


def test_keyframes_have_a_row_with_their_pose_and_pictures(writer):
    recorder = FrameRecorder(writer, RecordCfg())
    for step in range(11):
        recorder.offer(step, step * 0.1, lambda: CELLS, FRAME, AT)
    recorder.close()
    rows = (writer.folder / "frames/poses.csv").read_text().splitlines()
    assert rows[0] == ",".join(POSE_COLUMNS)
    assert rows[2] == "0.5,1,2,1.2,0.01,-0.02,0.5,1.1,2,0.5,000005_labels.png,000005_depth.png,,"
    assert len(rows) == 4
    assert kept(writer).count("000005_labels.png") == 1
    assert "000005_map.png" not in kept(writer)


def test_colour_is_kept_where_there_is_one(writer):
    recorder = FrameRecorder(writer, RecordCfg())
    recorder.offer(0, 0.0, lambda: CELLS, replace(FRAME, rgb=np.full((2, 2, 3), 90, np.uint8)), AT)
    recorder.close()
    assert (writer.folder / "frames/poses.csv").read_text().endswith(",000000_rgb.jpg,\n")
    assert cv2.imread(str(writer.folder / "frames/000000_rgb.jpg")).shape == (2, 2, 3)


@pytest.mark.parametrize("cfg", [RecordCfg(keyframes=False), RecordCfg(frames=False)])
def test_keyframes_can_be_switched_off(writer, cfg):
    recorder = FrameRecorder(writer, cfg)
    recorder.offer(0, 0.0, lambda: CELLS, FRAME, AT)
    recorder.close()
    assert not (writer.folder / "frames/poses.csv").exists()

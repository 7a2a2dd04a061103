"""The pictures that a run folder keeps."""

import dataclasses
import threading

import cv2
import numpy as np
import pytest

from coral.reef.geometry import Frame, Label
from coral.reef.record import COLUMNS, FrameRecorder, RecordCfg
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


def test_without_frames_nothing_is_kept(writer):
    recorder = FrameRecorder(writer, RecordCfg(frames=False))
    recorder.offer(0, 0.0, lambda: CELLS, FRAME)
    recorder.close()
    assert kept(writer) == []


class SlowDisk:
    """A run's writer that waits until it is told to go on."""

    def __init__(self):
        self.go, self.names = threading.Event(), []

    def bytes(self, name, content):
        assert self.go.wait(60.0)
        self.names.append(name)


def test_a_slow_disk_delays_nobody_and_what_it_cannot_take_is_counted():
    disk = SlowDisk()
    recorder = FrameRecorder(disk, RecordCfg(frame_period_s=1.0), patient=False)
    for step in range(5):
        recorder.offer(step, float(step), lambda: CELLS, FRAME)
    assert recorder.left_out == 3
    disk.go.set()
    recorder.close()
    assert sorted({name[:13] for name in disk.names}) == ["frames/000000", "frames/000001"]


def test_a_full_disk_is_told_at_the_next_set():
    class FullDisk:
        def bytes(self, name, content):
            raise OSError("no space left")

    recorder = FrameRecorder(FullDisk(), RecordCfg(frame_period_s=1.0))
    recorder.offer(0, 0.0, lambda: CELLS, FRAME)
    with pytest.raises(OSError, match="no space left"):
        recorder.close()


def test_colours_are_kept_where_there_are_any(tmp_path):
    kept = {}

    class Shelf:
        def bytes(self, name, content):
            kept[name] = content

    rgb = np.zeros((*FRAME.depth.shape, 3), np.uint8)
    rgb[..., 0] = 200
    for step, frame in enumerate((FRAME, dataclasses.replace(FRAME, rgb=rgb))):
        recorder = FrameRecorder(Shelf(), RecordCfg(frame_period_s=1.0))
        recorder.offer(step, 0.0, lambda: CELLS, frame)
        recorder.close()
    assert [name for name in kept if name.endswith("_rgb.png")] == ["frames/000001_rgb.png"]
    stored = cv2.imdecode(np.frombuffer(kept["frames/000001_rgb.png"], np.uint8), cv2.IMREAD_COLOR)
    assert np.array_equal(stored[..., ::-1], rgb)

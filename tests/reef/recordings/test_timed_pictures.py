"""Times of pictures."""

import subprocess

import cv2
import numpy as np
import pytest
from autopilot_logs import START_S
from PIL import Image

from coral.errors import InputError
from coral.reef.recordings.timed_pictures import find_pictures
from coral.view.mp4 import write_mp4

SIZE = (64, 48)


def picture(path, **exif):
    tags = Image.Exif()
    tags.get_ifd(0x8769).update({int(tag[1:], 16): text for tag, text in exif.items()})
    path.parent.mkdir(exist_ok=True)
    Image.new("RGB", SIZE).save(path, exif=tags)


@pytest.mark.parametrize(
    ("name", "after_s", "universal"),
    [
        ("1683220601.5", 1.5, True), ("cam_1683220601", 1.0, True), ("1683220601500", 1.5, True),
        ("left-1683220601500000000", 1.5, True), ("20230504_171641", 1.0, False),
        ("2023-05-04T17.16.41.25", 1.25, False), ("20230504T171641Z", 1.0, True),
    ],
)  # fmt: skip
def test_names_tell_times(tmp_path, name, after_s, universal):
    picture(tmp_path / "pictures" / f"{name}.jpg")
    picture(tmp_path / "pictures" / "1683220600.jpg")
    found = find_pictures(tmp_path, SIZE)
    assert (found.span, found.is_universal) == ((START_S, START_S + after_s), universal)
    assert found.rows(0.0, 0.0, 0.0)[1][2] == {"rgb": f"pictures/{name}.jpg"}


def test_exif_tells_times_of_a_known_or_an_unknown_zone(tmp_path):
    picture(tmp_path / "GOPR0002.jpg", x9003="2023:05:04 19:16:42", x9291="25", x9011="+02:00")
    picture(tmp_path / "GOPR0001.jpg", x9003="2023:05:04 17:16:41", x9011="+00:00")
    found = find_pictures(tmp_path, SIZE)
    assert (found.span, found.whose, found.is_universal) == ((START_S + 1.0, START_S + 2.25), "Exif", True)
    picture(tmp_path / "GOPR0003.jpg", x9003="2023:05:04 17:16:43")
    assert not find_pictures(tmp_path, SIZE).is_universal


def test_a_table_tells_times(tmp_path):
    (tmp_path / "times.csv").write_text("t,rgb\n1683220601.5,a.jpg\n1683220602,b.jpg\n")
    found = find_pictures(tmp_path, SIZE)
    assert (found.source.name, found.span) == ("times.csv", (START_S + 1.5, START_S + 2.0))


def video(path, *options):
    """Write a video of 4 s whose pictures show their time: a grey level more every frame."""
    frames = (np.full((SIZE[1], SIZE[0], 3), 20 + 2 * k, np.uint8) for k in range(80))
    write_mp4(path, frames, SIZE, 20.0, "-qp", "4", *options)


def test_a_videos_pictures_are_those_of_their_times(tmp_path):
    video(tmp_path / "dive.mp4", "-metadata", "creation_time=2023-05-04T17:16:40Z")
    found = find_pictures(tmp_path, SIZE)
    assert (found.span, found.is_universal) == ((START_S, START_S + 4.0), True)
    for begin, end, period_s, expected in ((-9.0, 9.0, 0.2, 20), (1.0, 2.0, 0.25, 4), (0.0, 1.0, 0.0, 20)):
        rows = found.rows(START_S + begin, START_S + end, period_s)
        assert len(rows) == expected
        assert rows[0][1]["t"] == START_S + max(begin, 0.0)
        for _, values, names in rows:
            shown_s = (cv2.imread(names["rgb"]).mean() - 20.0) / 2.0 / 20.0
            assert values["t"] - START_S == pytest.approx(shown_s, abs=0.06)


def test_a_video_without_a_creation_time_is_of_an_unknown_clock(tmp_path):
    video(tmp_path / "dive.mp4")
    found = find_pictures(tmp_path, SIZE)
    assert (found.span, found.whose, found.is_universal) == ((0.0, 4.0), "no creation time", False)


def test_a_video_that_takes_too_long_is_refused(tmp_path, monkeypatch):
    (tmp_path / "dive.mp4").write_bytes(b"video")

    def run(command, timeout, **options):
        raise subprocess.TimeoutExpired(command, timeout)

    monkeypatch.setattr(subprocess, "run", run)
    with pytest.raises(InputError, match=r"dive\.mp4: found more than 7200 s of work"):
        find_pictures(tmp_path, SIZE)


@pytest.mark.parametrize(
    ("names", "said"),
    [
        ([], "found neither pictures nor a video, expected a video, or pictures with times.csv"),
        (["a.mp4", "b.mp4"], "found a.mp4, b.mp4, expected one video"),
        (["a.mp4", "b.png"], "found a.mp4 and 1 pictures, expected one video"),
        (["a.mp4"], "a.mp4: found no pictures, expected a whole video that ffmpeg can read"),
        (["a.png"], "a.png: found no time, in its name or as Exif, expected"),
        (["20239904_991641.png"], "found no time"),
    ],
)
def test_pictures_without_times_are_refused(tmp_path, names, said):
    for name in names:
        (tmp_path / name).write_bytes(b"nothing")
    with pytest.raises(InputError) as caught:
        find_pictures(tmp_path, SIZE)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_video_of_another_camera_is_refused(tmp_path):
    video(tmp_path / "dive.mp4")
    with pytest.raises(InputError, match="found 64 x 48 pixels, expected 160 x 120, the size of the camera"):
        find_pictures(tmp_path, (160, 120))

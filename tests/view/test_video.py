import imageio_ffmpeg
import numpy as np
import pytest

from coral.errors import InputError
from coral.view.run import RunFolder
from coral.view.video import FPS, HEIGHT, LONGEST_S, WIDTH, moments, pictures, write_video


def test_the_film_has_a_picture_for_every_moment(fresh):
    path = write_video(fresh)
    count, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
    assert count == len(moments(40.0)) == 81
    assert seconds == pytest.approx(81 / FPS, abs=0.1)
    assert [file.name for file in fresh.glob("*.mp4")] == ["mission.mp4"]


def test_a_long_mission_makes_no_longer_film():
    assert len(moments(600.0)) == len(moments(6000.0)) == LONGEST_S * FPS
    assert moments(600.0)[0] == 0.0
    assert moments(600.0)[-1] == 600.0
    assert moments(0.0) == [0.0, 0.0]


@pytest.fixture
def brief(monkeypatch):
    """Films of twelve pictures."""
    monkeypatch.setattr("coral.view.video.LONGEST_S", 1.0)


def test_pictures_change_with_time(finished, brief):
    run = RunFolder.read(finished)
    every = list(pictures(run))
    assert all(p.shape == (HEIGHT, WIDTH, 3) and p.dtype == np.uint8 for p in every)
    assert (every[0] != every[-1]).any()


def test_a_killed_run_still_makes_a_film(killed, brief):
    assert write_video(killed).stat().st_size > 1000


@pytest.mark.parametrize("gone", ["*", "*_labels.png"])
def test_no_snapshots_no_film(fresh, gone):
    for file in (fresh / "frames").glob(gone):
        file.unlink()
    with pytest.raises(InputError, match="frames/"):
        write_video(fresh)

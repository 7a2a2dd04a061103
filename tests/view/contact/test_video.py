import imageio_ffmpeg
import pytest

from coral.errors import InputError
from coral.view.contact.replay import ReplayedScene
from coral.view.contact.video import moments as film_moments
from coral.view.contact.video import pictures, write_contact_video
from coral.view.run import RunFolder


def test_a_film_runs_in_real_time_unless_that_would_take_too_long():
    assert len(film_moments(0.8)) == 11
    assert len(film_moments(400.0)) == len(film_moments(40.0)) == 501


def test_a_film_has_a_picture_for_each_moment(recorded, monkeypatch):
    run = RunFolder.read(recorded)
    monkeypatch.setattr("coral.view.contact.video.WIDTH", 160)
    monkeypatch.setattr("coral.view.contact.video.HEIGHT", 120)
    film = list(pictures(run, ReplayedScene(run, (160, 120))))
    assert len(film) == len(film_moments(1.2))
    assert all(picture.shape == film[0].shape for picture in film)


def test_the_film_has_a_picture_for_each_moment_and_leaves_nothing_beside_it(copy):
    path = write_contact_video(copy)
    assert imageio_ffmpeg.count_frames_and_secs(str(path))[0] == len(film_moments(1.2))
    assert [file.name for file in copy.glob("*.mp4")] == ["episode.mp4"]


def test_a_run_without_states_has_no_film(copy):
    (copy / "states.csv").unlink()
    with pytest.raises(InputError, match="no states"):
        write_contact_video(copy)
    assert not list(copy.glob("*.mp4"))

import shutil

import numpy as np
import pytest
from recorded_scenes import write_scene

from coral.contact.real_scenes.bop_pictures import BopPictures
from coral.errors import InputError


@pytest.fixture
def folder(trial, tmp_path):
    write_scene(tmp_path / "scene", trial, colours="shaded")
    return tmp_path / "scene"


def test_pictures_are_read_as_a_camera_delivers_them(folder):
    pictures = BopPictures(folder)
    frame = pictures.read_frame(1, colours=True)
    assert pictures.indices == [0, 1]
    assert frame.names == ()
    assert not frame.instance.any()
    assert frame.rgb.shape == (48, 64, 3)
    assert frame.time_s == pytest.approx(0.1)


def test_colours_are_read_in_the_order_in_which_they_were_written(trial, tmp_path):
    frames = write_scene(tmp_path / "scene", trial, colours="shaded")
    assert np.array_equal(BopPictures(tmp_path / "scene").read_frame(0, colours=True).rgb, frames[0].rgb)


def test_colours_of_another_size_than_depth_are_refused(folder):
    shutil.copy(folder / "depth/000000.png", folder / "rgb/000000.png")
    with pytest.raises(InputError, match="rgb: 000000: found an array"):
        BopPictures(folder).read_frame(0, colours=True)

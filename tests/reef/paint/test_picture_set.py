"""Sets of pictures: what is written is read back; a broken one is named."""

import dataclasses

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.paint.picture_set import INDEX, TakenPicture, read_pictures, write_picture
from coral.reef.world.geometry import Frame, Pose

ABOUT = TakenPicture(
    name="0000", world="s1", water="jerlov-3C", pose=Pose(1.5, -2.25, 0.5), height=1.0, pitch_down_deg=15.0,
    hfov_deg=120.0, range_m=12.0,
)  # fmt: skip


def frame():
    rng = np.random.default_rng(0)
    depth = rng.uniform(0.1, 12.0, (6, 8)).astype(np.float32)
    depth[0] = np.inf
    labels = rng.integers(0, 4, (6, 8)).astype(np.uint8)
    return Frame(depth, labels, np.zeros((6, 8), np.int32), rng.integers(0, 255, (6, 8, 3)).astype(np.uint8))


def test_pictures_come_back(tmp_path):
    for k in range(2):
        write_picture(tmp_path / "set", dataclasses.replace(ABOUT, name=f"{k:04d}"), frame())
    (first, seen), (second, _) = read_pictures(tmp_path / "set")
    assert first == ABOUT
    assert second.name == "0001"
    assert np.array_equal(seen.rgb, frame().rgb)
    assert np.array_equal(seen.labels, frame().labels)
    np.testing.assert_allclose(seen.depth, frame().depth, atol=6e-4)


def test_a_folder_without_an_index_is_named(tmp_path):
    with pytest.raises(InputError, match=INDEX):
        list(read_pictures(tmp_path))


def test_a_missing_file_is_named(tmp_path):
    write_picture(tmp_path, ABOUT, frame())
    (tmp_path / "0000_depth.png").unlink()
    with pytest.raises(InputError, match="0000_depth"):
        list(read_pictures(tmp_path))


def test_a_broken_line_is_named(tmp_path):
    write_picture(tmp_path, ABOUT, frame())
    with (tmp_path / INDEX).open("a") as file:
        file.write("0001,s1,jerlov-3C,not a number\n")
    with pytest.raises(InputError, match="line 3"):
        list(read_pictures(tmp_path))


def test_a_frame_without_colours_is_no_picture(tmp_path):
    with pytest.raises(ValueError, match="no colours"):
        write_picture(tmp_path, ABOUT, dataclasses.replace(frame(), rgb=None))

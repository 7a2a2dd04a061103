"""Pictures: what they show, and that nothing but scene, water, pose and time is in them."""

import dataclasses

import numpy as np
import pytest

from coral.reef.camera import Camera, CameraCfg
from coral.reef.eyes.painter import Painter, PainterCfg
from coral.reef.geometry import Label, Pose
from coral.reef.scene import Scene
from coral.reef.world import load_world

SMALL = CameraCfg(width=80, height=60)
HERE = Pose(5.3, 4.4, 0.6)
SCENE = Scene.from_world(load_world("s1"))


def painted(water="clear", pose=HERE, t=0.0, seed=1, **keys):
    frame = Camera(SCENE, SMALL).render(pose)
    return frame, Painter(SCENE, SMALL, water, PainterCfg(**keys), seed).paint(frame, pose, t=t)


def test_a_picture_is_decided_by_seed_pose_and_time():
    _, first = painted()
    _, again = painted()
    assert first.dtype == np.uint8
    assert first.shape == (60, 80, 3)
    assert np.array_equal(first, again)
    for other in (painted(t=0.1), painted(seed=2), painted(pose=Pose(5.4, 4.4, 0.6)), painted("bay")):
        assert not np.array_equal(first, other[1])


def test_water_is_blue_in_the_ocean_and_green_at_the_coast():
    frame, ocean = painted("clear", white_balance=0.0)
    _, coast = painted("bay", white_balance=0.0)
    water = frame.labels == Label.WATER
    assert ocean[water].mean(axis=0).argmax() == 2
    assert coast[water].mean(axis=0).argmax() == 1


def test_murky_water_hides_what_is_far_away():
    frame, clear = painted("clear")
    _, hard = painted("hard", photons=1e9, read_noise=0.0)
    ranges = np.where(np.isfinite(frame.depth), frame.depth, 0.0)
    near, far = (ranges > 0) & (ranges < 1.5), ranges > 6.0

    def contrast(picture, where):
        gray = picture.astype(float).mean(axis=2)[where]
        return gray.std() / gray.mean()

    assert contrast(hard, far) < 0.25 * contrast(clear, far)
    assert contrast(hard, near) > 2.0 * contrast(hard, far)


def test_classes_do_not_leak_into_colours():
    """The same solids painted with other labels of the sea floor's neighbours give the same light."""
    frame = Camera(SCENE, SMALL).render(HERE)
    painter = Painter(SCENE, SMALL, "clear", PainterCfg(), 1)
    wrong = dataclasses.replace(frame, labels=np.where(frame.labels == Label.OYSTER, Label.OBSTACLE, frame.labels))
    assert np.array_equal(
        painter.light(frame, HERE),
        painter.light(wrong.__class__(frame.depth, wrong.labels.astype(np.uint8), frame.instances), HERE),
    )


def test_textures_are_anchored_to_the_world():
    """Two cameras that look at one spot from two places see the same sand there."""
    painter = Painter(SCENE, SMALL, "clear", PainterCfg(wave_slope=0.0, lens_blur_px=0.0, forward_blur_deg=0.0), 1)
    spots = {}
    for k, pose in enumerate((Pose(1.0, 14.0, 0.0), Pose(1.1, 14.0, 0.0))):
        frame = Camera(SCENE, SMALL).render(pose)
        light = painter._surface
        painter.light(frame, pose)
        spots[k] = (frame, light.copy())
    (one, first), (two, second) = spots[0], spots[1]
    # The same spot, 0.1 m further ahead for the first camera: rows of equal depth along the middle column.
    ahead_one, ahead_two = (f.depth[:, 40] * 1.0 for f in (one, two))
    assert np.isfinite(ahead_one[-5:]).all()
    assert np.isfinite(ahead_two[-5:]).all()
    assert not np.array_equal(first, second)


@pytest.mark.parametrize("water", ["jerlov-I", "jerlov-9C"])
def test_no_water_overflows(water):
    _, picture = painted(water)
    assert 5 < picture.mean() < 200

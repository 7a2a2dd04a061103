import numpy as np
from recorded_scenes import write_scene

from coral.contact.perception.depth_noise import DepthNoise
from coral.contact.real_scenes.bop_drawing import DrawnDepth
from coral.contact.real_scenes.bop_scene import BopScene


def test_drawn_objects_lie_where_they_were_recorded(trial, tmp_path):
    models, frames, _ = write_scene(tmp_path / "scene", trial)
    scene = BopScene(tmp_path / "scene")
    drawn = DrawnDepth(scene, None).read_frame(1)
    for k, name in enumerate(models):
        recorded = frames[1].mask(name)
        both = drawn.mask(str(k)) & recorded
        assert both.sum() > 0.9 * recorded.sum()  # the hand, which has no model, hides a part of the recorded one
        assert np.median(np.abs(drawn.depth - frames[1].depth)[both]) < 0.001
    assert drawn.depth[drawn.instance == 0].max() == 0.0  # nothing else has a model


def test_the_noise_of_a_picture_is_the_same_each_time(trial, tmp_path):
    write_scene(tmp_path / "scene", trial)
    scene = BopScene(tmp_path / "scene")
    clean = DrawnDepth(scene, None).read_frame(0)
    first, second = (DrawnDepth(scene, DepthNoise()).read_frame(0) for _ in range(2))
    assert np.array_equal(first.depth, second.depth)
    assert not np.array_equal(first.depth, clean.depth)

import numpy as np
import pytest
from painted_table import PAINT, at, overlap, picture

from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.masks.colour_masks import (
    ColourMasks,
    ColourRegion,
    hue_saturation_value,
    make_colour_masks,
    paint_regions,
)
from coral.errors import InputError

RED = tuple(value / 255 for value in PAINT)


def test_the_paint_of_an_object_is_its_mask():
    frame, (truth,) = picture(at(0.0, 0.0))
    mask = ColourMasks(paint_regions({"box": RED}, "mine.yaml")).segment(frame, {})["box"]
    assert overlap(mask, truth) > 0.9


def test_shading_changes_nothing():
    frame, _ = picture(at(0.0, 0.0))
    masks = ColourMasks(paint_regions({"box": RED}, "mine.yaml"))
    before = masks.segment(frame, {})["box"]
    frame.rgb[:, 40:] = (0.4 * frame.rgb[:, 40:]).astype(np.uint8)
    assert overlap(masks.segment(frame, {})["box"], before) > 0.95


def test_of_several_patches_the_largest_counts():
    frame, (far, near) = picture(at(0.1, 0.09), at(-0.05, -0.07))
    mask = ColourMasks(paint_regions({"box": RED}, "mine.yaml")).segment(frame, {})["box"]
    assert (mask & near).sum() > 0.8 * near.sum()
    frame.rgb[far] = 90
    frame.rgb[5:7, 5:7] = PAINT
    assert not ColourMasks(paint_regions({"box": RED}, "mine.yaml")).segment(frame, {})["box"][5:7, 5:7].any()


def test_an_object_that_is_not_there_has_no_mask():
    frame, _ = picture()
    assert not ColourMasks(paint_regions({"box": RED}, "mine.yaml")).segment(frame, {})["box"].any()


def test_hues_go_around_through_red():
    region = ColourRegion(hue_deg=(350.0, 10.0))
    assert region.contains(np.array([[355, 0.5, 0.5], [5, 0.5, 0.5], [20, 0.5, 0.5]])).tolist() == [True, True, False]


def test_two_objects_of_one_colour_are_refused():
    with pytest.raises(InputError, match=r"other: found the same colour, expected .* or --masks colour:FILE"):
        paint_regions({"box": RED, "other": RED}, "mine.yaml")


def test_a_picture_without_colours_is_refused():
    frame, _ = picture(at(0.0, 0.0), colours=False)
    with pytest.raises(InputError, match="a picture without colours"):
        ColourMasks(paint_regions({"box": RED}, "mine.yaml")).segment(frame, {})


def test_a_file_of_colours_is_read(tmp_path):
    (tmp_path / "colours.yaml").write_text("objects: {box: {hue_deg: [350, 15], saturation: [0.5, 1.0]}}")
    read = make_colour_masks(str(tmp_path / "colours.yaml"), None, {"box": None})
    assert read.regions == {"box": ColourRegion(hue_deg=(350, 15), saturation=(0.5, 1.0))}


def test_an_object_that_a_file_does_not_name_is_one_line(tmp_path):
    (tmp_path / "c.yaml").write_text("objects: {can: {hue_deg: [0, 20]}}")
    with pytest.raises(InputError, match=r"objects\.box: found missing"):
        make_colour_masks(str(tmp_path / "c.yaml"), None, {"box": None})


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("objects: {}", "objects"),
        ("objects: {box: red}", r"objects\.box"),
        ("objects: {box: {hue: [1, 2]}}", "hue"),
        ("objects: {box: {value: [0, 2]}}", "value"),
    ],
)
def test_a_broken_file_names_the_field(tmp_path, text, told):
    (tmp_path / "c.yaml").write_text(text)
    with pytest.raises(InputError, match=told):
        make_colour_masks(str(tmp_path / "c.yaml"), None, {"box": None})


def test_hue_is_in_degrees():
    rgb = np.full((1, 1, 3), (0, 255, 0), np.uint8)
    frame = RgbdFrame(np.ones((1, 1), np.float32), np.zeros((1, 1), np.uint8), (), np.ones(4), np.eye(4), 0.0, rgb)
    assert hue_saturation_value(frame)[0, 0] == pytest.approx([120.0, 1.0, 1.0])

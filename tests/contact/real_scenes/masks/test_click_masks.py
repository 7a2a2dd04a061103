import numpy as np
import pytest
from painted_table import BOX, PAINT, at, overlap, picture

from coral.contact.real_scenes.masks.click_masks import ClickMasks, read_clicks
from coral.errors import InputError


def click_on(mask):
    rows, columns = np.nonzero(mask)
    return float(np.median(columns)), float(np.median(rows))


@pytest.mark.parametrize("colours", [True, False])
def test_a_mask_grows_from_a_click_and_stops_at_the_table(colours):
    frame, (truth,) = picture(at(0.0, 0.0), colours=colours)
    mask = ClickMasks({"box": click_on(truth)}, {"box": BOX}).segment(frame, {})["box"]
    assert overlap(mask, truth) > 0.7
    assert not (mask & ~truth).any()


def test_a_neighbour_of_another_colour_stays_outside():
    frame, (truth, other) = picture(at(0.0, 0.0), at(0.0, 0.061), paints=(PAINT, (60, 90, 200)))
    mask = ClickMasks({"box": click_on(truth)}, {"box": BOX}).segment(frame, {})["box"]
    assert not (mask & other).any()


def test_the_mask_follows_the_tracked_pose():
    frame, (first, _) = picture(at(0.0, 0.0), at(0.0, 0.12))
    masks = ClickMasks({"box": click_on(first)}, {"box": BOX})
    masks.segment(frame, {})
    frame, (truth, other) = picture(at(0.015, 0.0), at(0.0, 0.12))
    mask = masks.segment(frame, {"box": at(0.0, 0.0)})["box"]
    assert overlap(mask, truth) > 0.75
    assert not (mask & other).any()  # of the same colour and depth, but too far away


def test_a_lost_object_is_searched_by_its_colour():
    frame, (first,) = picture(at(0.0, 0.0))
    masks = ClickMasks({"box": click_on(first)}, {"box": BOX})
    masks.segment(frame, {})
    masks.segment(frame, {"box": at(0.0, 0.0)})
    frame, (truth,) = picture(at(0.05, 0.12))
    assert overlap(masks.segment(frame, {})["box"], truth) > 0.75


def test_what_moves_in_front_does_not_join_the_mask():
    frame, (first,) = picture(at(0.0, 0.0), colours=False)
    masks = ClickMasks({"box": click_on(first)}, {"box": BOX})
    masks.segment(frame, {})
    frame.depth[:, 48:] = 0.3  # a hand over half of it
    mask = masks.segment(frame, {"box": at(0.0, 0.0)})["box"]
    assert mask[:, :48].any()
    assert not mask[:, 48:].any()


def test_masks_of_the_frame_are_not_read():
    frame, (truth,) = picture(at(0.0, 0.0))
    masks = ClickMasks({"box": click_on(truth)}, {"box": BOX})
    before = masks.segment(frame, {})["box"]
    frame.instance[:] = 1
    assert np.array_equal(ClickMasks({"box": click_on(truth)}, {"box": BOX}).segment(frame, {})["box"], before)


@pytest.mark.parametrize(
    ("click", "told"),
    [((500.0, 3.0), "a pixel of 96 x 72"), ((2.0, 2.0), "no depth"), ((48.0, 60.0), "nothing that stands out")],
)
def test_a_click_beside_the_object_is_one_line(click, told):
    frame, _ = picture(at(0.0, 0.0), paints=(PAINT,))
    frame.depth[:6, :6] = 0.0
    with pytest.raises(InputError, match=told):
        ClickMasks({"box": click}, {"box": BOX}).segment(frame, {})


@pytest.mark.parametrize("text", ["objects: {box: 3}", "objects: {box: [1]}", "objects: {box: [1, a]}", "box: [1, 2]"])
def test_a_broken_file_names_the_field(tmp_path, text):
    (tmp_path / "c.yaml").write_text(text)
    with pytest.raises(InputError, match="objects"):
        read_clicks(tmp_path / "c.yaml")


def test_clicks_are_columns_and_rows(tmp_path):
    (tmp_path / "c.yaml").write_text("objects: {box: [12, 34.5]}")
    assert read_clicks(tmp_path / "c.yaml") == {"box": (12.0, 34.5)}

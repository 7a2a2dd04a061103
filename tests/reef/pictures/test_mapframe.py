import numpy as np
import pytest

from coral.reef.pictures.mapframe import (
    CELL_COLORS,
    INK,
    LEGEND_PX,
    MAGENTA,
    MapPicture,
    draw_legend,
    draw_scale_bar,
    nice_step,
)


@pytest.mark.parametrize(
    ("span", "at_most", "step"), [(10.0, 10, 1.0), (10.0, 9, 2.0), (10.0, 4, 5.0), (0.7, 8, 0.1), (1300.0, 6, 500.0)]
)
def test_steps_are_round_and_few(span, at_most, step):
    assert nice_step(span, at_most) == pytest.approx(step)


def test_east_is_right_and_north_is_up():
    view = MapPicture(
        rgb=np.zeros((80, 60, 3), np.uint8), scale=10.0, left_px=5.0, bottom_px=75.0, window=(0.0, 0.0, 5.0, 7.0)
    )
    assert view.to_pixels(np.array([[0.0, 0.0], [1.0, 2.0]])).tolist() == [[5.0, 75.0], [15.0, 55.0]]


def test_the_paper_s_colours():
    white, gray, black, green = CELL_COLORS.astype(int)
    assert tuple(white) == (255, 255, 255)
    assert np.ptp(gray) < 10
    assert 120 < gray[0] < 220
    assert tuple(black) == (0, 0, 0)
    assert green[1] > 2 * green[0]


@pytest.mark.parametrize(("scale", "metres"), [(20.0, 5.0), (60.0, 2.0)])
def test_the_scale_bar_is_as_long_as_it_says(scale, metres):
    rgb = np.full((300, 600, 3), 255, np.uint8)
    draw_scale_bar(MapPicture(rgb=rgb, scale=scale, left_px=0.0, bottom_px=300.0, window=(0.0, 0.0, 1.0, 1.0)))
    (columns,) = np.nonzero((rgb[287] == INK).all(axis=1))
    bar = columns[: int(np.argmax(np.diff(columns) > 3)) + 1]
    assert bar[-1] - bar[0] == pytest.approx(metres * scale, abs=4)


def test_the_legend_fits_into_its_width_and_explains_a_goal_only_where_one_is():
    drawn = [np.full((60, LEGEND_PX + 200, 3), 255, np.uint8) for _ in range(2)]
    for rgb, goal in zip(drawn, (False, True), strict=True):
        draw_legend(rgb, 10, 5, goal)
        assert (rgb[:, LEGEND_PX + 20 :] == 255).all()
    without, with_goal = ((rgb == MAGENTA).all(axis=2).any() for rgb in drawn)
    assert (without, with_goal) == (False, True)

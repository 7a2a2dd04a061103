import math

import numpy as np
import pytest

from coral.reef.pictures.mapframe import PALE
from coral.reef.pictures.mapview import CELL_COLORS, HATCH, MapScene, draw_map, png
from coral.reef.world.geometry import Pose

WHOLE = (0.0, 0.0, 20.0, 20.0)

RED, BLUE, ORANGE, YELLOW = (220, 20, 40), (25, 90, 230), (255, 133, 0), (255, 217, 0)


def grid(metres=20.0, cell_m=0.05):
    return np.zeros((round(metres / cell_m), round(metres / cell_m)), np.uint8)


def pixel(picture, x, y):
    column, row = picture.to_pixels(np.array([x, y]))
    return tuple(int(v) for v in picture.rgb[int(row), int(column)])


def where(rgb, color, tolerance=12):
    """Mean (column, row) of the pixels of a colour; None without any."""
    rows, columns = np.nonzero((np.abs(rgb.astype(int) - color) <= tolerance).all(axis=2))
    return None if not len(rows) else (columns.mean(), rows.mean())


def has(rgb, color):
    return where(rgb, color) is not None


@pytest.mark.parametrize("window", [None, WHOLE])
@pytest.mark.parametrize("kind", [0, 1, 2, 3])
def test_a_cell_has_the_colour_of_its_class(kind, window):
    cells = grid()
    cells[80:120, 40:400] = 1  # so that a crop has something to keep
    cells[200:240, 100:140] = kind  # y 10..12 m, x 5..7 m
    picture = draw_map(MapScene(cells=cells, cell_m=0.05), window=window, legend=False)
    assert pixel(picture, 6.0, 11.0) == tuple(CELL_COLORS[kind])
    assert pixel(picture, 10.0, 5.0) == tuple(CELL_COLORS[1])


def test_north_is_up_and_east_is_right():
    cells = grid()
    cells[:200] = 1  # the southern half
    picture = draw_map(MapScene(cells=cells, cell_m=0.05), window=WHOLE, legend=False)
    assert pixel(picture, 10.0, 5.0) == tuple(CELL_COLORS[1])
    assert pixel(picture, 10.0, 15.0) == (255, 255, 255)
    low, high = picture.to_pixels(np.array([[0.0, 0.0], [20.0, 20.0]]))
    assert low[0] < high[0]
    assert low[1] > high[1]


@pytest.mark.parametrize("theta", [0.0, math.pi / 2, 2.5, -2.0])
def test_red_arrow_points_forward_and_blue_arrow_left(theta):
    scene = MapScene(cells=grid(), cell_m=0.05, pose=Pose(10.0, 10.0, theta))
    picture = draw_map(scene, window=WHOLE, legend=False)
    robot = picture.to_pixels(np.array([10.0, 10.0]))
    for color, angle in ((RED, theta), (BLUE, theta + math.pi / 2)):
        toward = np.array(where(picture.rgb, color)) - robot
        assert math.cos(math.atan2(-toward[1], toward[0]) - angle) > 0.99


def test_the_links_of_the_chain_are_blue():
    points = np.array([(4.0, 10.0), (16.0, 10.0), (10.0, 16.0)])
    view = {"window": WHOLE, "legend": False}
    joined = draw_map(MapScene(cells=grid(), cell_m=0.05, centroids=points, links=((0, 2), (2, 1))), **view)
    assert pixel(joined, 7.0, 13.0) == BLUE
    assert pixel(joined, 10.0, 10.0) == (255, 255, 255)
    assert pixel(joined, 4.0, 10.0) == ORANGE
    apart = draw_map(MapScene(cells=grid(), cell_m=0.05, centroids=points, links=()), **view)
    assert not has(apart.rgb, BLUE)


def test_a_visited_centroid_is_hollow():
    points = np.array([(4.0, 10.0), (16.0, 10.0)])
    scene = MapScene(cells=grid(), cell_m=0.05, centroids=points, visited=(True, False))
    picture = draw_map(scene, window=WHOLE)
    assert pixel(picture, 4.0, 10.0) != ORANGE
    assert pixel(picture, 16.0, 10.0) == ORANGE


def test_trajectory_is_yellow_with_a_dark_edge():
    scene = MapScene(cells=grid(), cell_m=0.05, trajectory=np.array([(3.0, 10.0), (17.0, 10.0)]))
    picture = draw_map(scene, window=WHOLE, legend=False)
    assert pixel(picture, 9.9, 10.0) == YELLOW
    column, row = (int(v) for v in picture.to_pixels(np.array([9.9, 10.0])))
    assert picture.rgb[row - 4 : row + 5, column].sum(axis=1).min() < 300


@pytest.mark.parametrize("at", [(0.05, 0.05), (19.95, 19.95), (0.05, 19.95), (19.95, 0.05)])
def test_labels_stay_inside_the_picture(at):
    scene = MapScene(cells=grid(), cell_m=0.05, centroids=np.array([at]), indices=(12,))
    view = {"window": WHOLE, "legend": False}
    ink = (150, 62, 0)
    corner = draw_map(scene, **view).rgb
    middle = draw_map(
        MapScene(cells=grid(), cell_m=0.05, centroids=np.array([(10.0, 10.0)]), indices=(12,)), **view
    ).rgb

    def amount(rgb):
        return (np.abs(rgb.astype(int) - ink) <= 3).all(axis=2).sum()

    assert amount(middle) > 20
    assert amount(corner) == amount(middle)


def test_the_crop_keeps_everything_that_is_drawn():
    cells = grid(30.0)
    cells[200:260, 200:260] = 1
    scene = MapScene(
        cells=cells, cell_m=0.05, pose=Pose(11.0, 11.0, 0.0), goal=(25.0, 11.0), centroids=np.array([(12.0, 20.0)])
    )
    picture = draw_map(scene)
    x0, y0, x1, y1 = picture.window
    assert 0 < x0 < 10
    assert 0 < y0 < 10
    assert 25 < x1 <= 30
    assert 20 < y1 <= 30
    assert max(x1 - x0, y1 - y0) <= 1.5 * min(x1 - x0, y1 - y0) + 0.2


def test_size_and_type_hold_for_any_shape():
    for shape in ((400, 400), (600, 200), (200, 600), (3, 5)):
        for view in ({}, {"size_px": 300, "legend": False}):
            rgb = draw_map(MapScene(cells=np.ones(shape, np.uint8), cell_m=0.05), **view).rgb
            assert rgb.dtype == np.uint8
            assert max(rgb.shape[:2]) <= view.get("size_px", 768)
            assert max(rgb.shape[:2]) >= view.get("size_px", 768) - 80


def test_the_legend_of_a_narrow_map_is_not_cut():
    cells = np.ones((600, 100), np.uint8)

    def lowest_rows(goal):
        rgb = draw_map(MapScene(cells=cells, cell_m=0.05, goal=goal)).rgb
        return rgb[-30:]  # the second line of the legend, where the goal stands last

    plain, with_goal = lowest_rows(None), lowest_rows((2.0, 2.0))
    assert has(with_goal, (190, 0, 170))
    columns = np.nonzero((plain != 255).any(axis=(0, 2)))[0]
    np.testing.assert_array_equal(with_goal[:, : columns[-1] + 1], plain[:, : columns[-1] + 1])
    assert (with_goal[:, -3:] == 255).all()


def test_the_same_scene_gives_the_same_bytes():
    scene = MapScene(cells=grid(), cell_m=0.05, pose=Pose(3, 4, 1), centroids=np.array([(5.0, 5.0)]))
    assert png(draw_map(scene).rgb) == png(draw_map(scene).rgb)


def test_a_dot_below_the_robot_s_arrow_stays_visible():
    points = np.array([(11.0, 10.0)])
    scene = MapScene(
        cells=grid(), cell_m=0.05, pose=Pose(4.0, 4.0, 0.0), arrival=Pose(10.0, 10.0, 0.0), centroids=points
    )
    picture = draw_map(scene, window=WHOLE)
    assert 0.0 < picture.to_pixels(points[0])[0] - picture.to_pixels(np.array([10.0, 10.0]))[0] < 50.0  # on the arrow
    assert pixel(picture, 11.0, 10.0) == ORANGE


def test_a_dot_that_is_done_is_hollow_also_where_it_is_known_from_afar():
    cells = np.ones((200, 200), np.uint8)
    scene = MapScene(
        cells=cells, cell_m=0.1, pose=Pose(3.0, 3.0, 0.0), centroids=np.array([[10.0, 10.0], [14.0, 14.0]]),
        visited=[True, False], seen=[None, None], indices=[4, 5],
    )  # fmt: skip
    view = draw_map(scene, legend=False)
    middles = [view.rgb[row, column].tolist() for column, row in np.rint(view.to_pixels(scene.centroids)).astype(int)]
    assert middles[0] == [255, 255, 255]
    assert middles[1] != [255, 255, 255]


def test_a_doubtful_dot_is_pale_and_has_a_mark_of_its_own():
    def middle(doubtful):
        scene = MapScene(cells=grid(), cell_m=0.05, centroids=np.array([[10.0, 10.0]]), seen=[0.5], doubtful=[doubtful])
        return draw_map(scene, window=WHOLE)

    plain, doubted = middle(False), middle(True)
    assert pixel(plain, 10.0, 10.0) == ORANGE
    assert pixel(doubted, 10.0, 10.0) == PALE
    label = slice(300, 345), slice(380, 460)
    assert (plain.rgb[label] != doubted.rgb[label]).any()


def test_water_that_is_not_worth_a_visit_is_hatched_and_other_white_is_not():
    idle = np.zeros((400, 400), bool)
    idle[100:140, 100:140] = True
    scene = MapScene(cells=grid(), cell_m=0.05, idle=idle)
    view = draw_map(scene, window=(-2.0, -2.0, 20.0, 20.0), legend=False)

    def hatched(x0, y0, x1, y1):
        (left, low), (right, high) = view.to_pixels(np.array([(x0, y0), (x1, y1)])).astype(int)
        return has(view.rgb[high:low, left:right], HATCH)

    assert hatched(5.0, 5.0, 7.0, 7.0)
    assert hatched(-2.0, 8.0, 0.0, 12.0)  # beyond the map
    assert not hatched(8.0, 8.0, 14.0, 14.0)


@pytest.mark.parametrize("size", [20.0, 60.0])
@pytest.mark.parametrize(
    ("x", "y", "theta"), [(0.975, 0.5, 0.0), (0.025, 0.025, 3.9), (0.5, 0.985, 1.57), (0.3, 0.02, -1.57)]
)
def test_arrows_and_the_end_of_the_area_are_in_the_picture(x, y, theta, size):
    cells, x, y = np.ones((round(10 * size), round(10 * size)), np.uint8), x * size, y * size
    scene = MapScene(
        cells=cells, cell_m=0.1, pose=Pose(10.0, 10.0, 0.0), arrival=Pose(x, y, theta), border=(0.0, 0.0, size, size)
    )
    view = draw_map(scene, legend=False)
    height, width = view.rgb.shape[:2]
    along = np.array([math.cos(theta), math.sin(theta)])
    for arrow in (72 * along, 62 * np.array([-along[1], along[0]])):  # with their names
        column, row = view.to_pixels(np.array([x, y])) + arrow * (1, -1)
        assert 40 <= column <= width - 12  # inside the axes
        assert 22 <= row <= height - 30
    x0, y0, x1, y1 = view.window
    assert min(x0, y0) < 0.0
    assert max(x1, y1) > size

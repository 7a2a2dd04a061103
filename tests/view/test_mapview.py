import math
from dataclasses import replace

import numpy as np
import pytest

from coral.reef.geometry import Frame, Pose
from coral.view.companions import COLORS, Companion
from coral.view.mapview import CELL_COLORS, MapScene, MapViewCfg, camera_picture, cell_classes, draw_map, png
from coral.view.pictures import draw_text, palette_png

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


@pytest.mark.parametrize("crop", [True, False])
@pytest.mark.parametrize("kind", [0, 1, 2, 3])
def test_a_cell_has_the_colour_of_its_class(kind, crop):
    cells = grid()
    cells[80:120, 40:400] = 1  # so that a crop has something to keep
    cells[200:240, 100:140] = kind  # y 10..12 m, x 5..7 m
    picture = draw_map(MapScene(cells=cells, cell_m=0.05), MapViewCfg(crop=crop, legend=False))
    assert pixel(picture, 6.0, 11.0) == tuple(CELL_COLORS[kind])
    assert pixel(picture, 10.0, 5.0) == tuple(CELL_COLORS[1])


def test_the_paper_s_colours():
    white, gray, black, green = CELL_COLORS.astype(int)
    assert tuple(white) == (255, 255, 255)
    assert np.ptp(gray) < 10
    assert 120 < gray[0] < 220
    assert tuple(black) == (0, 0, 0)
    assert green[1] > 2 * green[0]


def test_north_is_up_and_east_is_right():
    cells = grid()
    cells[:200] = 1  # the southern half
    picture = draw_map(MapScene(cells=cells, cell_m=0.05), MapViewCfg(crop=False, legend=False, axes=False))
    assert tuple(picture.rgb[-60, 380]) == tuple(CELL_COLORS[1])
    assert tuple(picture.rgb[60, 380]) == (255, 255, 255)
    low, high = picture.to_pixels(np.array([[0.0, 0.0], [20.0, 20.0]]))
    np.testing.assert_allclose(low, (0, picture.rgb.shape[0]))
    np.testing.assert_allclose(high, (picture.rgb.shape[1], 0), atol=1e-6)


@pytest.mark.parametrize("theta", [0.0, math.pi / 2, 2.5, -2.0])
def test_red_arrow_points_forward_and_blue_arrow_left(theta):
    scene = MapScene(cells=grid(), cell_m=0.05, pose=Pose(10.0, 10.0, theta))
    picture = draw_map(scene, MapViewCfg(crop=False, legend=False, axes=False))
    robot = picture.to_pixels(np.array([10.0, 10.0]))
    for color, angle in ((RED, theta), (BLUE, theta + math.pi / 2)):
        toward = np.array(where(picture.rgb, color)) - robot
        assert math.cos(math.atan2(-toward[1], toward[0]) - angle) > 0.99


def test_chain_is_blue_in_the_given_order():
    points = np.array([(4.0, 10.0), (16.0, 10.0), (10.0, 16.0)])
    cfg = MapViewCfg(crop=False, legend=False, labels=False)
    joined = draw_map(MapScene(cells=grid(), cell_m=0.05, centroids=points, chain=(0, 2, 1)), cfg)
    assert pixel(joined, 7.0, 13.0) == BLUE
    assert pixel(joined, 10.0, 10.0) == (255, 255, 255)
    assert pixel(joined, 4.0, 10.0) == ORANGE
    apart = draw_map(MapScene(cells=grid(), cell_m=0.05, centroids=points, chain=()), cfg)
    assert not has(apart.rgb, BLUE)


def test_a_visited_centroid_is_hollow():
    points = np.array([(4.0, 10.0), (16.0, 10.0)])
    scene = MapScene(cells=grid(), cell_m=0.05, centroids=points, visited=(True, False))
    picture = draw_map(scene, MapViewCfg(crop=False, labels=False))
    assert pixel(picture, 4.0, 10.0) != ORANGE
    assert pixel(picture, 16.0, 10.0) == ORANGE


def test_trajectory_is_yellow_with_a_dark_edge():
    scene = MapScene(cells=grid(), cell_m=0.05, trajectory=np.array([(3.0, 10.0), (17.0, 10.0)]))
    picture = draw_map(scene, MapViewCfg(crop=False, legend=False))
    assert pixel(picture, 9.9, 10.0) == YELLOW
    column, row = (int(v) for v in picture.to_pixels(np.array([9.9, 10.0])))
    assert picture.rgb[row - 4 : row + 5, column].sum(axis=1).min() < 300


@pytest.mark.parametrize("at", [(0.05, 0.05), (19.95, 19.95), (0.05, 19.95), (19.95, 0.05)])
def test_labels_stay_inside_the_picture(at):
    scene = MapScene(cells=grid(), cell_m=0.05, centroids=np.array([at]), indices=(12,))
    cfg = MapViewCfg(crop=False, legend=False, axes=False)
    ink = (150, 62, 0)
    corner = draw_map(scene, cfg).rgb
    middle = draw_map(MapScene(cells=grid(), cell_m=0.05, centroids=np.array([(10.0, 10.0)]), indices=(12,)), cfg).rgb

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
        for cfg in (MapViewCfg(), MapViewCfg(crop=False), MapViewCfg(size_px=300, legend=False, axes=False)):
            rgb = draw_map(MapScene(cells=np.ones(shape, np.uint8), cell_m=0.05), cfg).rgb
            assert rgb.dtype == np.uint8
            assert max(rgb.shape[:2]) <= cfg.size_px
            assert max(rgb.shape[:2]) >= cfg.size_px - 80


def test_the_legend_of_a_narrow_map_is_not_cut():
    cells = np.ones((600, 100), np.uint8)

    def lowest_rows(goal):
        rgb = draw_map(MapScene(cells=cells, cell_m=0.05, goal=goal), MapViewCfg(crop=False)).rgb
        return rgb[-50:]

    plain, with_goal = lowest_rows(None), lowest_rows((2.0, 2.0))
    assert has(with_goal, (190, 0, 170))
    columns = np.nonzero((plain != 255).any(axis=(0, 2)))[0]
    np.testing.assert_array_equal(with_goal[:, : columns[-1] + 1], plain[:, : columns[-1] + 1])
    assert (with_goal[:, -3:] == 255).all()


def test_the_same_scene_gives_the_same_bytes():
    scene = MapScene(cells=grid(), cell_m=0.05, pose=Pose(3, 4, 1), centroids=np.array([(5.0, 5.0)]))
    assert png(draw_map(scene).rgb) == png(draw_map(scene).rgb)


def test_oysters_win_over_obstacles_and_both_over_free_space():
    yes, no = np.ones((1, 3), bool), np.zeros((1, 3), bool)
    obstacle, target = no.copy(), no.copy()
    obstacle[0, 1:] = target[0, 2] = True
    np.testing.assert_array_equal(cell_classes(yes, obstacle, target), [[1, 2, 3]])


def test_camera_pictures_show_classes_and_distance():
    labels = np.repeat(np.arange(4, dtype=np.uint8), 40)[None].repeat(120, axis=0)
    depth = np.full((120, 160), 2.0, np.float32)
    depth[:, 80:] = 6.0
    depth[:20] = np.inf
    frame = Frame(depth, labels, np.full((120, 160), -1, np.int32))
    seen = camera_picture(frame)
    assert seen.shape == (480, 640, 3)
    water, oyster, rock, seabed = (seen[240, x].astype(int) for x in (80, 240, 400, 560))
    assert water[2] > water[0]
    assert oyster[1] > 2 * oyster[0]
    assert rock.max() < 60
    assert np.ptp(seabed) < 25
    far = camera_picture(frame, "depth")
    assert far[200, 100].sum() > far[200, 500].sum() > far[10, 100].sum()


def test_indexed_png_reads_back(tmp_path):
    import cv2

    rng = np.random.default_rng(0)
    for count in (4, 200):
        classes = rng.integers(0, count, (7, 13)).astype(np.uint8)
        palette = rng.integers(0, 256, (count, 3)).astype(np.uint8)
        back = cv2.imdecode(np.frombuffer(palette_png(classes, palette), np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
        np.testing.assert_array_equal(back, palette[classes])


def test_text_never_leaves_the_picture():
    image = np.full((40, 60, 3), 255, np.uint8)
    draw_text(image, "long words that do not fit", 55, 38, size=20, halo=3)
    draw_text(image, "x", -500, -500)
    assert image.shape == (40, 60, 3)


def test_other_robots_have_their_own_colours_and_a_key():
    pair = (
        Companion(
            pose=Pose(5.0, 15.0, 0.0),
            goal=(15.0, 15.0),
            trajectory=np.array([(2.0, 15.0), (5.0, 15.0)]),
            color=COLORS[1],
        ),
        Companion(pose=Pose(5.0, 5.0, 0.0), color=COLORS[2]),
    )
    whole = MapViewCfg(crop=False)
    scene = MapScene(cells=grid(), cell_m=0.05, pose=Pose(10.0, 10.0, 0.0), others=pair)
    drawn = draw_map(scene, whole)
    assert pixel(drawn, 5.0, 15.0) == pixel(drawn, 3.0, 15.0) == COLORS[1]
    assert pixel(drawn, 5.0, 5.0) == COLORS[2]
    keyed = draw_map(replace(scene, named=True), whole)
    assert has(keyed.rgb[22:80, -150:], COLORS[2])
    assert not has(drawn.rgb[22:80, -150:], COLORS[2])

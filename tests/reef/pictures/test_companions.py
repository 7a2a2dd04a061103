from dataclasses import replace

import numpy as np

from coral.reef.pictures.companions import COLORS, Companion, draw_companions
from coral.reef.pictures.mapframe import MapPicture
from coral.reef.pictures.mapview import MapScene, MapViewCfg, draw_map
from coral.reef.world.geometry import Pose


def grid(metres=20.0, cell_m=0.05):
    return np.zeros((round(metres / cell_m), round(metres / cell_m)), np.uint8)


def pixel(picture, x, y):
    column, row = picture.to_pixels(np.array([x, y]))
    return tuple(int(v) for v in picture.rgb[int(row), int(column)])


def has(rgb, color):
    return (np.abs(rgb.astype(int) - color) <= 12).all(axis=2).any()


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


def test_a_robot_that_is_nowhere_yet_has_a_goal_only():
    rgb = np.full((200, 200, 3), 255, np.uint8)
    view = MapPicture(rgb=rgb, scale=10.0, left_px=0.0, bottom_px=200.0, window=(0.0, 0.0, 20.0, 20.0))
    draw_companions(view, (Companion(pose=None, color=COLORS[2]),))
    assert (rgb == 255).all()
    draw_companions(view, (Companion(pose=None, goal=(10.0, 10.0), color=COLORS[2]),))
    assert tuple(rgb[100, 111]) == COLORS[2]
    assert tuple(rgb[100, 100]) == (255, 255, 255)

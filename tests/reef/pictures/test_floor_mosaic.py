"""The floor from above, from pictures at a slant."""

import numpy as np

from coral.reef.generator.generated import one_thing
from coral.reef.map.belief import Belief
from coral.reef.map.mapping import OccupancyMap
from coral.reef.pictures.floor_mosaic import CELL_PX, seen_floor, split_bands
from coral.reef.pictures.mapview import MapScene, draw_map
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene

WORLD = one_thing("tyre")


def painted(belief, pose):
    """Let the robot see a still whose left half is red and whose right half is blue."""
    still = np.zeros((960, 1280, 3), np.uint8)
    still[:, :640, 0], still[:, 640:, 2] = 200, 200
    frame = Camera(Scene.from_world(WORLD), belief.map.camera).render(pose)
    belief.update(type(frame)(frame.depth, frame.labels, frame.instances, still=lambda: still), pose)


def test_what_is_on_the_left_of_a_picture_is_on_the_left_of_the_robot():
    belief = Belief(OccupancyMap(WORLD.size_m, CameraCfg()))
    assert seen_floor(belief) is None
    pose = Pose(6.0, 10.0, 0.0)
    painted(belief, pose)
    floor = seen_floor(belief)
    assert floor.shape == (CELL_PX * belief.map.target.shape[0], CELL_PX * belief.map.target.shape[1], 3)
    px = CELL_PX / belief.map.cfg.cell_m
    left, right = (floor[round((pose.y + side) * px), round((pose.x + 2.0) * px)].astype(int) for side in (0.7, -0.7))
    assert left[0] > left[2] + 50
    assert right[2] > right[0] + 50
    assert (floor[0, 0] == 235).all()


def test_it_is_drawn_where_the_map_is():
    cells = np.zeros((40, 60), np.uint8)
    floor = np.full((80, 120, 3), 235, np.uint8)
    floor[60:, :40] = (200, 0, 0)  # north west
    drawn = draw_map(MapScene(cells=cells, cell_m=0.25, floor=floor), legend=False)
    x, y = drawn.to_pixels(np.array((2.0, 9.0)))
    assert tuple(drawn.rgb[round(y), round(x)]) == (200, 0, 0)
    x, y = drawn.to_pixels(np.array((12.0, 2.0)))
    assert tuple(drawn.rgb[round(y), round(x)]) == (235, 235, 235)


def test_bands_add_up_to_the_picture_and_differences_of_light_fade():
    rng = np.random.default_rng(0)
    rgb = rng.integers(0, 255, (60, 80, 3)).astype(np.uint8)
    coarse, detail = split_bands(rgb, 0.05)
    np.testing.assert_allclose(coarse + detail, rgb, atol=1e-3)
    assert coarse.std() < 0.3 * rgb.std()
    assert not split_bands(rgb, 0.0)[0].any()

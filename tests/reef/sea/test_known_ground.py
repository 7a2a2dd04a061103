import numpy as np
import pytest

from coral.reef.map.mapping import OccupancyMap
from coral.reef.sea.known_ground import BARE, BODY_CELLS, OBSTACLE, OYSTER, KnownGround
from coral.reef.vehicle.camera import CameraCfg


@pytest.fixture
def cells():
    cells = OccupancyMap((4.0, 3.0), CameraCfg())
    cells.explored[:] = True
    cells.obstacle[10:14, 20:24] = True
    cells.target[40:44, 50:54] = True
    return cells


def no_fence(cells):
    return np.zeros(cells.target.shape, np.bool_)


def test_every_seen_cell_is_of_one_kind(cells):
    ground = KnownGround.of_map(cells, no_fence(cells))
    assert (ground.masks.sum(axis=0) == 1).all()
    assert [int(mask.sum()) for mask in ground.masks] == [16, 16, cells.target.size - 32]


def test_a_fence_is_nothing_that_was_seen(cells):
    forbidden = no_fence(cells)
    forbidden[10:14, 20:24] = True
    ground = KnownGround.of_map(cells, forbidden)
    assert not ground.masks[OBSTACLE].any()
    assert not ground.seen[10:14, 20:24].any()


def test_points_are_centres_of_cells_of_their_kind(cells):
    places, kinds = KnownGround.of_map(cells, no_fence(cells)).points()
    assert set(kinds) == {OBSTACLE, OYSTER, BARE}
    assert places[kinds == OBSTACLE].min(axis=0) == pytest.approx([20.5 * 0.05, 10.5 * 0.05])
    assert len(places[kinds == OBSTACLE]) == 4  # 16 cells of 0.05 m, one for every 0.1 m


def test_bodies_are_found_one_by_one_and_specks_are_not(cells):
    cells.obstacle[50:53, 5:9] = True
    cells.obstacle[2, 2] = True
    bodies = KnownGround.of_map(cells, no_fence(cells)).bodies()
    assert sorted((kind, len(at)) for kind, at in bodies) == [(OBSTACLE, BODY_CELLS), (OBSTACLE, 16), (OYSTER, 16)]


def test_an_empty_map_has_nothing():
    cells = OccupancyMap((4.0, 3.0), CameraCfg())
    ground = KnownGround.of_map(cells, no_fence(cells))
    assert len(ground.points()[0]) == len(ground.bodies()) == 0

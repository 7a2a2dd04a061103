import math

import numpy as np
import pytest

from coral.reef.map.belief import Belief
from coral.reef.map.carried import AROUND_M, is_jump, moved, moved_cells
from coral.reef.map.mapping import OccupancyMap
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose

CELL_M = 0.05


def at(x, y):
    return int(y / CELL_M), int(x / CELL_M)


def around(x, y):
    """A square of 0.25 m."""
    row, column = at(x, y)
    return slice(row - 2, row + 3), slice(column - 2, column + 3)


def mapped(occupied, clear):
    """A map on which places (m) were seen: with an obstacle, or without."""
    grid = OccupancyMap((12.0, 12.0), CameraCfg(width=40, height=30))
    for places, counts in ((occupied, grid._obstacles), (clear, grid._ground)):
        for x, y in places:
            counts[around(x, y)], grid.explored[around(x, y)] = 9, True
    grid._classify((0, 240, 0, 240))
    return grid


@pytest.mark.parametrize(
    ("after", "jumped"),
    [(Pose(5.1, 5.0, 0.0), False), (Pose(5.2, 5.0, 0.0), True), (Pose(5.0, 5.0, 0.02), False), (Pose(5, 5, 0.1), True)],
)
def test_a_small_correction_is_no_jump(after, jumped):
    assert is_jump(Pose(5.0, 5.0, 0.0), after) is jumped


def test_a_motion_is_made_in_the_robots_frame():
    turned = moved(Pose(1.0, 1.0, math.pi / 2), Pose(5.0, 5.0, 0.0), Pose(6.0, 5.5, 0.1))
    assert turned == pytest.approx((0.5, 2.0, math.pi / 2 + 0.1))


def test_small_corrections_add_up():
    belief = Belief(mapped(occupied=[(6.02, 5.02)], clear=[(5.02, 5.02)]))
    for k in range(4):
        assert belief.map.obstacle[at(6.02, 5.02)]
        belief.correct(Pose(5.0 + 0.05 * k, 5.0, 0.0), Pose(5.05 + 0.05 * k, 5.0, 0.0))
    assert belief.map.obstacle[at(6.22, 5.02)]


def test_to_drive_is_no_correction():
    belief = Belief(mapped(occupied=[(6.02, 5.02)], clear=[(5.02, 5.02)]))
    version = belief.map.version
    for k in range(20):
        pose = Pose(5.0 + 0.05 * k, 5.0, 0.03 * k)
        belief.correct(pose, pose)
    assert belief.map.version == version


def test_cells_keep_their_place_in_the_robots_frame():
    before, after = Pose(5.0, 5.0, 0.3), Pose(6.1, 4.2, -0.5)
    to, source = moved_cells((240, 240), CELL_M, before, after)

    def seen_from(pose, cells):
        rows, columns = np.divmod(cells, 240)
        x, y = (columns + 0.5) * CELL_M - pose.x, (rows + 0.5) * CELL_M - pose.y
        c, s = math.cos(pose.theta), math.sin(pose.theta)
        return np.stack([c * x + s * y, -s * x + c * y])

    assert np.abs(seen_from(after, to) - seen_from(before, source)).max() < CELL_M
    assert np.hypot(*seen_from(after, to)).max() <= AROUND_M
    assert len(to) > 0.9 * math.pi * (AROUND_M / CELL_M) ** 2


def test_at_the_edge_only_cells_of_the_map_are_moved():
    to, source = moved_cells((240, 240), CELL_M, Pose(0.2, 0.2, 0.0), Pose(1.2, 11.9, 0.0))
    assert len(to) == len(source) > 0
    assert min(to.min(), source.min()) >= 0
    assert max(to.max(), source.max()) < 240 * 240


def test_what_was_seen_moves_with_the_robot_and_what_was_not_seen_stays():
    before, after = Pose(5.0, 5.0, 0.0), Pose(6.0, 5.0, math.pi / 2)
    grid = mapped(occupied=[(6.02, 5.02), (6.52, 7.02)], clear=[(5.02, 5.02), (5.52, 5.02)])
    version = grid.version
    grid.carry(before, after)
    assert grid.version > version
    assert not grid.obstacle[at(6.02, 5.02)]  # where the robot is now; it was clear where it was
    assert grid.obstacle[at(5.98, 6.02)]  # a metre ahead, as before
    assert grid.obstacle[at(6.52, 7.02)]  # nothing was seen there that could take its place


def test_what_is_closed_off_stays_closed():
    grid = mapped(occupied=[], clear=[(5.02, 5.02)])
    closed = np.zeros_like(grid.obstacle)
    closed[at(6.02, 5.02)] = True
    grid.close_off(closed)
    grid.carry(Pose(5.0, 5.0, 0.0), Pose(6.0, 5.0, 0.0))
    assert grid.obstacle[at(6.02, 5.02)]


def resumed():
    """A map that goes on with an earlier survey's, in which an obstacle stands at (6.02, 5.02)."""
    grid = mapped(occupied=[], clear=[])
    grid.recall(mapped(occupied=[(6.02, 5.02)], clear=[(5.52, 5.02)]).memory())
    return grid


def seen(grid, occupied):
    for x, y in occupied:
        grid._obstacles[around(x, y)], grid.explored[around(x, y)] = 9, True
    grid._classify((0, 240, 0, 240))


def test_what_an_earlier_survey_knew_stays_and_what_this_one_saw_is_carried():
    grid = resumed()
    seen(grid, [(6.02, 6.02)])
    grid.carry(Pose(5.0, 5.0, 0.0), Pose(5.5, 5.0, 0.0))
    assert grid.obstacle[at(6.02, 5.02)]
    assert not grid.obstacle[at(6.52, 5.02)]
    assert not grid.obstacle[at(5.52, 5.02)]
    assert grid.obstacle[at(6.52, 6.02)]


def test_once_a_resumed_survey_is_found_the_saved_map_is_as_it_was_but_for_what_is_around_the_robot():
    belief = Belief(resumed())
    saved = belief.map.memory()
    seen(belief.map, [(6.02, 6.02), (5.52, 5.02), (9.02, 9.02)])
    belief.map._targets[at(4.02, 5.02)] = 9
    belief.correct(Pose(5.0, 5.0, 0.0), Pose(5.5, 5.0, 0.0), found=True)
    assert belief.map.obstacle[at(6.52, 6.02)]
    assert not belief.map.obstacle[at(6.02, 6.02)]
    now = belief.map.memory()
    changed = np.argwhere((now["_obstacles"] != saved["_obstacles"]) | (now["_targets"] != saved["_targets"]))
    assert np.abs((changed + 0.5) * CELL_M - (6.02, 6.52)).max() < 0.2


def test_lines_of_sight_begin_anew_with_the_saved_obstacles():
    grid = resumed()
    grid.sight = grid._begin_sight()
    grid.sight.obstacle[around(9.02, 9.02)] = grid.sight.odds[around(9.02, 9.02)] = True
    grid._combine((0, 240, 0, 240))
    assert grid.obstacle[at(9.02, 9.02)]
    grid.carry(Pose(5.0, 5.0, 0.0), Pose(5.5, 5.0, 0.0), anew=True)
    assert [bool(grid.obstacle[at(*place)]) for place in ((6.02, 5.02), (9.02, 9.02))] == [True, False]

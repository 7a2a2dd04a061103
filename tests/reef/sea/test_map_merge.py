import math

import numpy as np

from coral.reef.map.mapping import OccupancyMap
from coral.reef.map.mapping_kernels import SATURATED
from coral.reef.sea.local_frame import LocalFrame, turned_about
from coral.reef.sea.map_merge import merge_maps
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose


def memory(**cells):
    """The memory of a map of 6 m by 5 m, with some cells set: name=((slices), value)."""
    empty = OccupancyMap((6.0, 5.0), CameraCfg()).memory()
    for name, (where, value) in cells.items():
        empty[name][where] = value
    return empty


NO_FENCE = np.zeros((100, 120), np.bool_)
BLOCK = np.s_[20:30, 40:60]


def merged(saved, new, shift=None, forbidden=NO_FENCE):
    return merge_maps(saved, new, shift or LocalFrame(), 0.05, forbidden)


def test_what_a_dive_has_seen_comes_where_it_lies_on_the_saved_map():
    shift = turned_about(Pose(2.5, 1.25, 0.0), 1.0, 0.5, math.pi / 2)  # about the middle of the block
    found = merged(memory(), memory(_obstacles=(BLOCK, 7), explored=(BLOCK, True), nearest=(BLOCK, 1.5)), shift)
    expected = np.zeros((100, 120), np.uint16)
    expected[25:45, 65:75] = 7
    assert np.array_equal(found["_obstacles"], expected)
    assert np.array_equal(found["explored"], expected > 0)
    assert np.array_equal(np.isfinite(found["nearest"]), expected > 0)


def test_evidence_of_both_counts_and_does_not_overflow():
    saved = memory(_targets=(BLOCK, 5), _ground=(BLOCK, SATURATED - 1), nearest=(BLOCK, 2.0), unseeable=(BLOCK, True))
    new = memory(_targets=(BLOCK, 3), _ground=(BLOCK, SATURATED - 1), nearest=(BLOCK, 3.0), explored=(BLOCK, True))
    found = merged(saved, new)
    assert (found["_targets"][BLOCK] == 8).all()
    assert (found["_ground"][BLOCK] == SATURATED).all()
    assert (found["nearest"][BLOCK] == 2.0).all()
    assert found["unseeable"][BLOCK].all()


def test_the_fence_of_the_wrong_frame_is_no_evidence():
    forbidden = NO_FENCE.copy()
    forbidden[BLOCK] = True
    found = merged(memory(), memory(_obstacles=(BLOCK, SATURATED)), forbidden=forbidden)
    assert not found["_obstacles"].any()


def test_nothing_seen_changes_nothing_and_neither_does_what_lies_outside():
    saved = memory(_obstacles=(BLOCK, 4))
    far = LocalFrame(100.0, 0.0, 0.0)
    for new, shift in ((memory(), LocalFrame()), (memory(_obstacles=(BLOCK, 4)), far)):
        found = merged(saved, new, shift)
        assert all(np.array_equal(found[name], saved[name]) for name in saved)
        assert found["_obstacles"] is not saved["_obstacles"]

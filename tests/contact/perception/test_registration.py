"""Registration: an object is found without a previous pose, whichever way it is turned."""

import numpy as np
import pytest
from drawn_object import BOARD, BOX, CAN, LENS, picture, tilted

from coral.contact.perception.agreement_kernels import AGREE, DRAWN, FREE, HIDDEN, RESIDUAL, UNCOVERED, WRONG
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.registration import misfit, register, start_orientations
from coral.contact.scene.geometry import spread_rotations


def found(model, T, robot=None):
    depth, mask = picture(model, T)
    none = np.zeros_like(mask) if robot is None else robot
    depth = np.where(none, 0.3, depth).astype(np.float32)
    frame = RgbdFrame(depth, none.astype(np.uint8), ("robot",), LENS, np.eye(4))
    return register(model, start_orientations(model), frame, mask & ~none)


@pytest.mark.parametrize("model", [BOX, BOARD, CAN], ids=["box", "board", "can"])
@pytest.mark.parametrize("turn", [(2.8, 0.5, -0.4), (-0.3, 2.0, 1.5)])
def test_any_orientation_is_found(model, turn):
    truth = tilted(turn)
    shift, angle = model.symmetry.difference(found(model, truth), truth)
    assert shift < 0.002
    assert np.degrees(angle) < 1.0


def test_a_half_hidden_object_is_found():
    truth = tilted()
    mask = picture(BOARD, truth)[1]
    robot = np.zeros_like(mask)
    robot[:, : int(np.median(np.nonzero(mask)[1]))] = True
    shift, angle = BOARD.symmetry.difference(found(BOARD, truth, robot), truth)
    assert shift < 0.005
    assert np.degrees(angle) < 3.0


def test_the_misfit_of_a_tally():
    tally = np.zeros(7)
    assert misfit(tally) == np.inf  # nothing to see explains nothing
    tally[[AGREE, WRONG, UNCOVERED, FREE, HIDDEN, DRAWN, RESIDUAL]] = 80, 10, 6, 4, 20, 110, 8
    assert misfit(tally) == pytest.approx((20 + 0.5 * 8 + 0.1 * 20) / 100)


def test_orientations_cover_what_the_symmetry_leaves():
    for model, limit in ((CAN, 40), (BOX, 140), (BOARD, 260)):
        turns = start_orientations(model)
        assert 8 <= len(turns) <= limit
        group = model.symmetry.members(36)[:, :3, :3]
        farthest = max(
            min(np.arccos(np.clip((np.einsum("gij,ij->g", t @ group, r) - 1) / 2, -1, 1)).min() for t in turns)
            for r in spread_rotations(60)
        )
        assert np.degrees(farthest) < 40

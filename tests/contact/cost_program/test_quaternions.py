"""Quaternion arithmetic agrees with SciPy, for constants and for batches."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coral.contact.cost_program import CostError
from coral.contact.cost_program.quaternions import (
    angle,
    conjugate,
    difference,
    euler,
    matrix,
    normalised,
    product,
    read_quat,
    rotate,
    write_quat,
)
from coral.contact.cost_program.values import Seq, Vec

TURNS = Rotation.random(6, rng=np.random.default_rng(0))
OTHERS = Rotation.random(6, rng=np.random.default_rng(1))


def batch(rotations):
    """(w, x, y, z), each Shape=(1, 6)."""
    return tuple(rotations.as_quat(scalar_first=True).T[:, None, :])


def stacked(value):
    return np.stack([np.asarray(item)[0] for item in value], axis=-1)


def test_a_batch_of_products_and_rotated_vectors_agrees_with_scipy(meter):
    found = stacked(product(meter, batch(TURNS), batch(OTHERS)))
    np.testing.assert_allclose(Rotation.from_quat(found, scalar_first=True).as_matrix(), (TURNS * OTHERS).as_matrix())
    np.testing.assert_allclose(
        stacked(rotate(meter, batch(TURNS), (0.2, -0.5, 1.1)).items), TURNS.apply([0.2, -0.5, 1.1])
    )
    np.testing.assert_allclose(np.stack([stacked(row) for row in matrix(meter, batch(TURNS))], 1), TURNS.as_matrix())


def test_euler_angles_agree_with_scipy(meter):
    angles = euler(meter, batch(TURNS)).items
    np.testing.assert_allclose(stacked(angles), TURNS.as_euler("xyz"))


def test_euler_angles_of_a_constant_are_plain_numbers(meter):
    assert all(isinstance(item, float) for item in euler(meter, (1.0, 0.0, 0.0, 0.0)).items)


def test_the_difference_is_the_shorter_rotation(meter):
    found = difference(meter, batch(TURNS), tuple(-x for x in batch(OTHERS)))
    assert (found[0] >= 0.0).all()
    np.testing.assert_allclose(
        Rotation.from_quat(stacked(found), scalar_first=True).as_matrix(), (OTHERS * TURNS.inv()).as_matrix()
    )


def test_the_angle_is_exact_where_an_arc_cosine_is_not(meter):
    small = 1e-9
    assert angle(meter, (1.0, 0.0, 0.0, 0.0), (np.cos(small / 2), np.sin(small / 2), 0.0, 0.0)) == pytest.approx(
        small, rel=1e-9
    )
    np.testing.assert_allclose(angle(meter, batch(TURNS), batch(OTHERS))[0], (OTHERS * TURNS.inv()).magnitude())


def test_the_conjugate_undoes_a_rotation(meter):
    there = rotate(meter, batch(TURNS), (1.0, 2.0, 3.0)).items
    np.testing.assert_allclose(
        stacked(rotate(meter, conjugate(meter, batch(TURNS)), there).items), np.tile([1.0, 2.0, 3.0], (6, 1))
    )


def test_a_quaternion_is_read_and_written_in_either_order(meter):
    assert read_quat(meter, Vec((1.0, 2.0, 3.0, 4.0)), "xyzw") == (4.0, 1.0, 2.0, 3.0)
    assert read_quat(meter, Seq((1.0, 2.0, 3.0, 4.0)), "wxyz") == (1.0, 2.0, 3.0, 4.0)
    written = write_quat((4.0, 1.0, 2.0, 3.0), "xyzw")
    assert (written.items, written.order) == ((1.0, 2.0, 3.0, 4.0), "xyzw")


@pytest.mark.parametrize(("known", "wanted"), [("wxyz", "xyzw"), ("xyzw", "wxyz")])
def test_a_quaternion_that_is_known_to_have_the_other_order_is_refused(known, wanted, meter):
    with pytest.raises(CostError) as caught:
        read_quat(meter, Vec((1.0, 0.0, 0.0, 0.0), known), wanted)
    assert caught.value.code == "quaternion_order"


def test_a_normalised_quaternion_has_length_one(meter):
    assert normalised(meter, (0.0, 3.0, 0.0, 4.0)) == (0.0, 0.6, 0.0, 0.8)

import numpy as np
import pytest

from coral.reef.paint.collage import BARE, OTHER, CollagePainter, bare_picture
from coral.reef.world.geometry import Label


def test_clumps_have_oysters_and_the_same_seed_draws_the_same():
    def drawn():
        rng = np.random.default_rng(4)
        painter = CollagePainter(rng)
        return [painter.clumps((96, 64), rng) for _ in range(4)]

    first, again = drawn(), drawn()
    assert set(np.unique([one.target for one in first])) == {int(Label.OYSTER), OTHER}
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a.rgb, b.rgb)
        np.testing.assert_array_equal(a.target, b.target)


@pytest.mark.parametrize("kind", BARE)
def test_a_bare_picture_has_no_oyster_and_is_not_one_colour(kind):
    one = bare_picture(kind, (96, 64), np.random.default_rng(0))
    assert one.rgb.shape == (64, 96, 3)
    assert (one.target == OTHER).all()
    assert one.rgb.std() > 1.0

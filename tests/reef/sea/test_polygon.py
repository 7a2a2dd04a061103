from hypothesis import given
from hypothesis import strategies as st

from coral.reef.sea.polygon import contains_point, is_simple

L_SHAPE = ((0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4))


def test_an_l_contains_its_arms_and_not_its_notch():
    assert contains_point(L_SHAPE, 3.5, 0.5)
    assert contains_point(L_SHAPE, 0.5, 3.5)
    assert not contains_point(L_SHAPE, 2.0, 2.0)
    assert not contains_point(L_SHAPE, -0.1, 0.5)


@given(st.floats(-2, 6), st.floats(-2, 6), st.integers(0, 5))
def test_containment_does_not_depend_on_the_first_corner(x, y, k):
    assert contains_point(L_SHAPE, x, y) == contains_point(L_SHAPE[k:] + L_SHAPE[:k], x, y)


def test_a_bow_tie_crosses_itself():
    assert is_simple(L_SHAPE)
    assert not is_simple(((0, 0), (1, 1), (1, 0), (0, 1)))


def test_corners_on_a_line_enclose_nothing():
    assert not is_simple(((0, 0), (1, 0), (2, 0)))

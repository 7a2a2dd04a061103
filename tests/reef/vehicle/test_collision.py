import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from coral.reef.vehicle.collision import ContactCounter, clearance
from coral.reef.vehicle.collision_kernels import ellipse_distance
from coral.reef.world.scene import ELLIPSE, RECTANGLE, Footprints


def outlines(*rows):
    """Rows of (kind, x, y, half x, half y, yaw)."""
    table = np.array(rows, float).reshape(-1, 6)
    return Footprints(table[:, 0].astype(np.int8), table[:, 1:3].copy(), table[:, 3:5].copy(), table[:, 5].copy())


def boundary(footprint, k, n=4000):
    """Points on outline k."""
    a, b = footprint.half[k]
    if footprint.kind[k] == ELLIPSE:
        angle = np.linspace(0, 2 * math.pi, n)
        local = np.stack([a * np.cos(angle), b * np.sin(angle)], axis=1)
    else:
        s = np.linspace(-1, 1, n // 4)
        one = np.ones_like(s)
        local = np.concatenate(
            [np.stack([s, one], 1), np.stack([s, -one], 1), np.stack([one, s], 1), np.stack([-one, s], 1)]
        ) * [a, b]
    c, s_ = math.cos(footprint.yaw[k]), math.sin(footprint.yaw[k])
    return local @ np.array([[c, s_], [-s_, c]]) + footprint.center[k]


def test_hand_computed_distances():
    circle = outlines((ELLIPSE, 2, 3, 0.5, 0.5, 0))
    assert clearance(circle, 5, 7) == pytest.approx(4.5)
    assert clearance(circle, 2, 3) == pytest.approx(-0.5)
    square = outlines((RECTANGLE, 0, 0, 1, 1, math.pi / 4))
    assert clearance(square, 2, 0) == pytest.approx(2 - math.sqrt(2))
    assert clearance(square, 0, 0) == pytest.approx(-1.0)
    assert clearance(square, 1, 1) == pytest.approx(math.sqrt(2) - 1)
    long = outlines((ELLIPSE, 0, 0, 3, 1, math.pi / 2))
    assert clearance(long, 0, 5) == pytest.approx(2.0)
    assert clearance(long, 5, 0) == pytest.approx(4.0)
    assert clearance(long, 0, 0) == pytest.approx(-1.0)
    # From (0, 2) the nearest point of x^2 + y^2/9 = 1 has y = 9 y0 / 8 = 2.25, off the long axis.
    assert clearance(long, 0, 2) == pytest.approx(-math.hypot(math.sqrt(1 - 2.25**2 / 9), 0.25))


@given(
    st.floats(0.05, 3),
    st.floats(0.05, 3),
    st.floats(-5, 5),
    st.floats(-5, 5),
)
@settings(max_examples=150, deadline=None)
def test_ellipse_distance_equals_a_dense_search(a, b, x, y):
    angle = np.linspace(0, 2 * math.pi, 20001)
    expected = np.hypot(a * np.cos(angle) - x, b * np.sin(angle) - y).min()
    step = max(a, b) * math.pi / 20000
    found = ellipse_distance(x, y, a, b)
    assert abs(found) == pytest.approx(expected, abs=step)
    if abs(found) > 1e-9:
        assert (found > 0) == ((x / a) ** 2 + (y / b) ** 2 > 1)


def test_nearest_equals_the_search_over_all_outlines():
    rng = np.random.default_rng(3)
    n = 25
    field = Footprints(
        rng.integers(0, 2, n).astype(np.int8),
        rng.uniform(0, 10, (n, 2)),
        rng.uniform(0.1, 1, (n, 2)),
        rng.uniform(-3, 3, n),
    )
    edges = [boundary(field, k) for k in range(n)]
    checked = 0
    for x, y in rng.uniform(-1, 11, (200, 2)):
        distances = np.array([np.hypot(*(edge - [x, y]).T).min() for edge in edges])
        found = clearance(field, x, y)
        if found > 0:
            checked += 1
            assert found == pytest.approx(distances.min(), abs=2e-3)
        else:
            assert np.abs(distances + found).min() < 2e-3
    assert checked > 50


def touch(contact, x, y):
    """Move to a point, and return the obstacles newly touched."""
    return tuple(k for _, _, k in contact.follow(np.array([[x, y]], float)))


def test_sliding_along_an_obstacle_is_one_contact():
    contact = ContactCounter(outlines((RECTANGLE, 0, 0, 1, 1, 0)), radius=0.3, release_m=0.05)
    for y in np.linspace(-0.9, 0.9, 30):
        touch(contact, 1.3 - 1e-6 + 0.04 * math.sin(40 * (y + 0.9)) ** 2, y)
    assert contact.count == 1


def test_a_contact_counts_again_only_after_leaving():
    contact = ContactCounter(outlines((ELLIPSE, 0, 0, 1, 1, 0)), radius=0.3, release_m=0.05)
    assert touch(contact, 1.31, 0) == ()
    assert touch(contact, 1.29, 0) == (0,)
    assert touch(contact, 1.34, 0) == ()
    assert touch(contact, 1.29, 0) == ()
    assert touch(contact, 1.36, 0) == ()
    assert touch(contact, 1.29, 0) == (0,)
    assert contact.count == 2


def test_a_jump_away_ends_a_contact_too():
    contact = ContactCounter(outlines((ELLIPSE, 0, 0, 1, 1, 0)))
    assert touch(contact, 1.2, 0)
    assert not touch(contact, 50, 0)
    assert touch(contact, 1.2, 0) == (0,)


def test_two_obstacles_touched_at_once_are_two_contacts():
    contact = ContactCounter(outlines((ELLIPSE, -1, 0, 0.8, 0.8, 0), (RECTANGLE, 1, 0, 0.8, 0.8, 0)), radius=0.3)
    assert touch(contact, 0, 0) == (0, 1)
    assert contact.count == 2


def test_clearance_of_the_hull_is_less_by_its_radius():
    contact = ContactCounter(outlines((ELLIPSE, 0, 0, 1, 1, 0)), radius=0.3)
    assert contact.clearance(2, 0) == pytest.approx(0.7)
    assert contact.clearance(1.1, 0) == pytest.approx(-0.2)


def test_a_track_has_the_contacts_of_its_points():
    shapes = outlines((ELLIPSE, 0, 0, 1, 0.6, 0.4), (RECTANGLE, 2, 1, 0.5, 0.8, 1.0), (ELLIPSE, -1, 2, 0.4, 0.4, 0))
    track = np.random.default_rng(3).normal(0.0, 0.12, (400, 2)).cumsum(axis=0)
    single, whole = ContactCounter(shapes), ContactCounter(shapes)
    one_by_one = [(x, y, hit) for x, y in track.tolist() for hit in touch(single, x, y)]
    assert len(one_by_one) > 5
    assert [hit for piece in np.split(track, 8) for hit in whole.follow(piece)] == one_by_one
    assert whole.count == single.count

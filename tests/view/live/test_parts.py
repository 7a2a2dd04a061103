import numpy as np
import pytest

from coral.reef.world import load_world
from coral.view.live import cards, reef_scene
from coral.view.live.history import History, thinned
from coral.view.live.pace import Pace
from coral.view.live.panel import named, speeds
from coral.view.live.scene import blocks
from coral.view.live.state import Answered, Asked, LiveState, Number
from coral.view.live.strokes import arrow, bundle, oval, path, rectangle, ring


def test_blocks_stand_on_the_cells_and_nowhere_else():
    mask = np.random.default_rng(1).random((9, 13)) < 0.4
    vertices, faces = blocks(mask, 0.5, (2.0, -1.0), 0.3)
    assert faces.max() < len(vertices)
    top = vertices[faces].reshape(-1, 3, 3)
    top = top[(top[:, :, 2] == np.float32(0.3)).all(axis=1)]
    areas = 0.5 * np.cross(top[:, 1] - top[:, 0], top[:, 2] - top[:, 0])[:, 2]
    assert (areas > 0).all()  # seen from above
    assert areas.sum() == pytest.approx(0.25 * mask.sum())
    boxes = vertices.reshape(-1, 8, 3)
    covered = np.zeros_like(mask)
    for box in boxes:
        x0, x1 = (round((v - 2.0) / 0.5) for v in (box[:, 0].min(), box[:, 0].max()))
        y0 = round((box[:, 1].min() + 1.0) / 0.5)
        covered[y0, x0:x1] = True
    assert (covered == mask).all()


def test_blocks_of_nothing():
    vertices, faces = blocks(np.zeros((3, 4), bool), 1.0, (0.0, 0.0), 1.0)
    assert (vertices.shape, faces.shape) == ((0, 3), (0, 3))


def test_strokes():
    points = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 2.0)])
    segments = path(points, 0.5)
    assert segments.tolist() == [[[0, 0, 0.5], [1, 0, 0.5]], [[1, 0, 0.5], [1, 2, 0.5]]]
    assert path(points[:1], 0.5).shape == path(points[:0], 0.5).shape == (0, 2, 3)
    assert bundle(np.stack([points, points + 1]), 0.0).shape == (4, 2, 3)
    assert np.hypot(*(ring(3.0, 4.0, 2.0, 0.0)[:, 0, :2] - (3, 4)).T) == pytest.approx(2.0)
    assert arrow(np.zeros(2), np.array([1.0, 0.0]), 0.0)[0, 1, :2].tolist() == [1.0, 0.0]
    turned = rectangle(np.array([1.0, 1.0]), np.array([2.0, 0.5]), np.pi / 2)
    assert turned[0] == pytest.approx((1.5, -1.0))
    assert oval(np.array([1.0, 1.0]), np.array([2.0, 0.5]), np.pi / 2)[0] == pytest.approx((1.0, 3.0))


def test_the_truth_is_a_layer_of_its_own():
    world = load_world("l1")
    (line,) = reef_scene.truth(world)
    assert line.layer == "truth"
    xy = line.segments[..., :2].reshape(-1, 2)
    oyster = world.clusters[0].oysters[0]
    assert np.hypot(*(xy - (oyster.x, oyster.y)).T).min() < max(oyster.radii)
    assert reef_scene.truth(None) == ()


class Wall:
    def __init__(self):
        self.now, self.rests = 0.0, []

    def clock(self):
        return self.now

    def wait(self, seconds):
        self.rests.append(seconds)
        self.now += seconds


def test_a_speed_limit_holds_and_nothing_is_hurried():
    wall = Wall()
    pace = Pace(2.0, clock=wall.clock, wait=wall.wait)
    for k in range(101):
        pace.keep(0.1 * k)
    assert wall.now == pytest.approx(5.0)
    wall.now += 60.0  # the machine was busy
    pace.keep(10.1)
    pace.keep(10.2)
    assert wall.now == pytest.approx(65.05)
    pace.speed = 0.0
    pace.keep(1000.0)
    assert wall.now == pytest.approx(65.05)


def test_standing_still_ends_with_the_pause_or_the_run():
    wall, seen = Wall(), []
    pace = Pace(clock=wall.clock, wait=wall.wait)
    assert not pace.stand_still(lambda: seen.append(1))
    pace.paused = True
    assert pace.stand_still(lambda: seen.append(1) or (len(seen) == 3 and setattr(pace, "paused", False)))
    assert len(seen) == 3
    pace.paused = True
    assert pace.stand_still(pace.end)
    assert pace.stop
    assert not pace.stand_still(lambda: pytest.fail("the run is over"))


def test_a_history_stays_small_and_keeps_its_ends():
    history = History(("a", "b"), limit=64)
    for k in range(1000):
        history.add(0.1 * k, k, -k)
    t, values = history.curves(["b"])
    assert 32 <= len(t) <= 64
    assert (t[0], t[-1]) == (0.0, pytest.approx(99.9, abs=3.2))
    assert np.allclose(values[0], -10 * t)
    assert np.allclose(np.diff(t), t[1] - t[0])


def test_recorded_curves_are_thinned():
    t = np.arange(5000.0)
    few, values = thinned(t, np.stack([t, 2 * t]))
    assert len(few) == 400
    assert (few[0], few[-1]) == (0.0, 4999.0)
    assert (values[1] == 2 * few).all()


def test_words_from_outside_stay_words():
    bad = "<img src=x onerror=alert(1)>'\""
    state = LiveState(
        title=bad,
        about=bad,
        status=bad,
        numbers=(Number(name=bad, value=bad),),
        log=(bad,),
        note=bad,
        asked=Asked(title=bad, mode=bad, since_s=1.0, cause=bad),
        answered=Answered(verdict=bad, said=bad, at_s=1.0, reason=bad),
        legend=(((1, 2, 3), bad),),
    )
    for html in (cards.head(state), cards.decision(state), cards.log(state), cards.legend(state)):
        assert "<img" not in html
        assert "&lt;img" in html


def test_the_decision_card_says_since_when_and_why():
    state = LiveState(
        title="x",
        t=75.0,
        asked=Asked(title="Where to next?", mode="waypoint", since_s=63.0, attempt=1),
        answered=Answered(verdict="rejected", said="3 m ahead", at_s=62.0, reason="It leads back."),
    )
    html = cards.decision(state)
    for words in (
        "Where to next?",
        "waypoint mode, attempt 2",
        "open since 1:03, for 12 s",
        "rejected",
        "It leads back.",
    ):
        assert words in html


def test_the_speed_to_begin_with_can_be_chosen_again():
    assert list(speeds(4.0)) == [
        "real time",
        "2 × real time",
        "4 × real time",
        "5 × real time",
        "10 × real time",
        "20 × real time",
    ]
    assert speeds(0.0) == speeds(5.0)
    assert named(0.0) == "as fast as possible"

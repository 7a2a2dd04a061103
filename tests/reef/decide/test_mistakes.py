import math
from collections import Counter

import numpy as np
import pytest

from coral.advisor.question import Question
from coral.advisor.setting import Earlier
from coral.reef.decide.answers import CentroidChoice, WaypointChoice
from coral.reef.decide.mistakes import REEF_MISTAKES

ERR = {mistake.name: mistake.err for mistake in REEF_MISTAKES}


def dots(*places):
    return [{"index": k, "forward_m": float(f), "left_m": float(s)} for k, (f, s) in enumerate(places)]


def centroid(*places, asked_at_s=0.0):
    facts = {"centroids": dots(*places)}
    return Question(kind="reef-centroid", prompt="", answer_type=CentroidChoice, facts=facts, asked_at_s=asked_at_s)


WAYPOINT = Question(kind="reef-waypoint", prompt="", answer_type=WaypointChoice, facts={"centroids": []})


def err(name, question, right, earlier=(), n=1):
    rng = np.random.default_rng(0)
    found = [ERR[name](question, right, earlier, rng) for _ in range(n)]
    return found[0] if n == 1 else found


def chosen(index):
    return {"selected_centroid_index": index, "reason": "it is new"}


def step(forward, left):
    return {"forward_m": forward, "left_m": left, "reason": "on"}


def test_a_dot_is_confused_with_near_ones_the_nearer_the_likelier():
    question = centroid((4, 0), (4, 1), (4, -3), (4, 8))
    picked = Counter(wrong["selected_centroid_index"] for wrong in err("dots", question, chosen(0), n=2000))
    assert set(picked) == {1, 2}  # the last one is no neighbour
    assert picked[2] / picked[1] == pytest.approx(math.exp(-1.0), rel=0.15)  # 2 m farther
    assert err("dots", centroid((4, 0), (4, 8)), chosen(0)) is None
    assert err("dots", centroid((4, 0)), chosen(None)) is None


def test_a_waypoint_is_blurred_in_angle_and_distance():
    wrong = err("blurred", WAYPOINT, step(4, 0), n=2000)
    assert all((w["forward_m"], w["left_m"]) != (4, 0) for w in wrong)
    assert all(abs(w["forward_m"]) <= 6 and abs(w["left_m"]) <= 6 for w in wrong)
    angles = np.array([math.atan2(w["left_m"], w["forward_m"]) for w in wrong])
    assert math.degrees(float(np.mean(angles))) == pytest.approx(0.0, abs=3.0)
    assert 15.0 < math.degrees(float(np.std(angles))) < 35.0
    reach = np.log([math.hypot(w["left_m"], w["forward_m"]) / 4.0 for w in wrong if w["forward_m"] or w["left_m"]])
    assert 0.2 < float(np.std(reach)) < 0.45
    assert err("blurred", WAYPOINT, step(0, 0)) is None


def test_left_and_right_are_swapped():
    wrong = err("mirrored", WAYPOINT, step(3, 2))
    assert (wrong["forward_m"], wrong["left_m"]) == (3, -2)
    assert err("mirrored", WAYPOINT, step(3, 0)) is None
    question = centroid((4, 3), (4, 2), (5, -3), (1, 1))
    assert err("mirrored", question, chosen(0))["selected_centroid_index"] == 2
    assert err("mirrored", centroid((4, 3), (4, 2)), chosen(0)) is None  # no dot where it would lie


def test_the_map_is_turned_by_a_quarter_to_either_side():
    turned = {(w["forward_m"], w["left_m"]) for w in err("rotated", WAYPOINT, step(4, 1), n=40)}
    assert turned == {(-1, 4), (1, -4)}
    question = centroid((4, 0), (0, 4), (0, -4), (-4, 0))
    assert {w["selected_centroid_index"] for w in err("rotated", question, chosen(0), n=40)} == {1, 2}


def test_a_stale_answer_is_ten_seconds_old_at_least():
    earlier = [Earlier(at_s=t, answer=chosen(k)) for k, t in enumerate((0.0, 5.0, 20.0))]
    question = centroid((4, 0), asked_at_s=20.0)
    assert err("stale", question, chosen(3), earlier)["selected_centroid_index"] == 1
    assert err("stale", question, chosen(1), earlier) is None  # still right
    assert err("stale", centroid((4, 0), asked_at_s=9.0), chosen(3), earlier[:1]) is None

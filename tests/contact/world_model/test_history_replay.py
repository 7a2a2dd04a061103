import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from histories import TOOL, history, sliding

from coral.contact.control.rollouts import SLEEP
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.world_model import history_replay as module
from coral.contact.world_model.history_replay import HistoryReplay, most_informative_object, windows

NEAR, FAR = (0.0, 0.0, 0.1), (0.0, 0.0, -0.1)


def scorer():
    return HistoryReplay(SimpleNamespace(edges=False), [])


def window(one, command, steps=4):
    """Steps in which everything was measured to stay where it is, whatever was commanded."""
    begun = history(steps, box=one.now.objects["box"].position)
    still = [dataclasses.replace(one.now, time_s=step.before.time_s) for step in begun]
    ends = [dataclasses.replace(one.now, time_s=step.after.time_s) for step in begun]
    target = dataclasses.replace(
        begun[0].command, position=one.now.tool.position, quaternion=one.now.tool.quaternion, **command
    )
    return [
        dataclasses.replace(step, before=before, command=target, after=after)
        for step, before, after in zip(begun, still, ends, strict=True)
    ]


def parts(one, command, **beliefs):
    believed = {**one.beliefs, **beliefs}
    return HistoryReplay(one.world, [window(one, command)]).parts([believed], "box")[0, 0]


def test_what_was_measured_as_replayed_leaves_little_over(scene):
    place, turn, speed, hand, force = parts(scene("pick-box"), {})
    assert max(place, turn, speed, hand, force) < 1.0


def test_a_hand_that_did_not_follow_its_command_is_an_error_of_the_hand(scene):
    one = scene("pick-box")
    place, turn, speed, hand, _ = parts(one, {"force": np.array([6.0, 0.0, 0.0])})
    assert hand > 3.0
    assert max(place, turn, speed) < 1.0


def test_a_commanded_force_is_replayed_as_a_target_that_pulls_as_hard(scene):
    one = scene("pick-box")
    ahead = one.now.tool.position + np.array([0.01, 0.0, 0.0])
    pushed = parts(one, {"force": np.array([6.0, 0.0, 0.0]), "stiffness": 600.0})
    replay = HistoryReplay(one.world, [window(one, {"stiffness": 600.0})])
    (steps,) = replay.windows
    replay.windows = [
        [dataclasses.replace(s, command=dataclasses.replace(s.command, position=ahead)) for s in steps],
    ]
    np.testing.assert_allclose(replay.parts([one.beliefs], "box")[0, 0], pushed, rtol=1e-9)


def test_beliefs_are_replayed_side_by_side(scene):
    one = scene("pick-box")
    heavy = {"box": PhysicalParameters(5.0, 0.5)}
    both = HistoryReplay(one.world, [window(one, {})] * 2).parts([one.beliefs, heavy], "box")
    assert both.shape == (2, 2, 5)
    np.testing.assert_allclose(both[:, 0], both[:, 1])


def test_nothing_sleeps_in_a_replay(scene):
    one = scene("pick-clutter")
    assert all(model.opt.enableflags & SLEEP == SLEEP for model in one.world.models)
    begun = history(3, **{name: body.position for name, body in one.now.objects.items()})
    steps = [dataclasses.replace(step, before=one.now, after=one.now) for step in begun]
    HistoryReplay(one.world, [steps]).parts([one.beliefs], "can")
    assert not any(model.opt.enableflags & SLEEP for model in one.world.models)


def test_a_score_is_the_mean_square_of_what_exceeds_the_floor_up_to_a_bound():
    score = scorer().score(np.array([[[3.0, 4.0, 100.0]]]), np.array([[2.0, 0.0, 0.0]]))
    assert score == pytest.approx((1.0**2 + 4.0**2 + 6.0**2) / 3)


def test_a_window_that_diverges_under_every_belief_decides_nothing():
    found = np.array([[[1.0, 2.0], [np.inf, np.inf]], [[3.0, 2.0], [np.inf, np.inf]]])
    score = scorer().score(found, found.min(axis=0))
    assert np.isfinite(score).all()
    assert score[0, 1] == score[1, 1]
    assert score[0, 0] < score[1, 0]


def test_a_belief_under_which_a_window_diverges_scores_worse_than_one_under_which_it_does_not():
    found = np.array([[[1.0, 2.0]], [[np.inf, np.inf]]])
    score = scorer().score(found, found.min(axis=0))
    assert score[0, 0] < score[1, 0] == 36.0


def firsts(found):
    """The step at which each window begins."""
    return [round(window[0].before.time_s / 0.02) for window in found]


def test_a_history_without_touch_says_nothing():
    still = history(30, box=NEAR)
    assert windows(still, "box") == []
    assert most_informative_object(still) is None
    assert most_informative_object([]) is None


def test_windows_of_an_object_that_slides_overlap_by_half():
    found = windows(history(24, box=sliding(1.0)), "box")
    assert firsts(found) == [0, 6, 12]
    assert {len(window) for window in found} == {12}


def test_a_history_shorter_than_a_window_has_none():
    assert windows(history(11, box=sliding(1.0)), "box") == []


def test_what_resists_a_force_tells_something_where_the_hand_is_near_it():
    assert firsts(windows(history(12, box=NEAR, force=(1.0, 0.0, 0.0)), "box")) == [0]
    assert windows(history(12, box=FAR, force=(1.0, 0.0, 0.0)), "box") == []
    assert windows(history(12, box=NEAR, force=(0.2, 0.0, 0.0)), "box") == []


@pytest.mark.parametrize(("most", "kept"), [(1, [24]), (3, [0, 18, 24])])
def test_the_windows_that_tell_most_are_kept_in_the_order_of_time(monkeypatch, most, kept):
    # 1 mm per step until step 12, nothing until 24, then 3 mm
    def place(k):
        return np.array([0.001 * min(k, 12) + 0.003 * max(0, k - 24), 0.0, 0.03])

    steps = history(36, box=place)
    monkeypatch.setattr(module, "MOST_WINDOWS", most)
    assert firsts(windows(steps, "box")) == kept


def test_no_window_spans_a_gap_in_time_or_begins_where_no_replay_can():
    steps = history(12, box=sliding(1.0)) + history(12, box=sliding(1.0), start_s=1.0)
    assert firsts(windows(steps, "box")) == [0, 50]
    assert firsts(windows(steps, "box", usable=lambda start: start.time_s > 0.5)) == [50]


def test_the_object_that_moved_farthest_tells_most_though_it_came_back():
    def to_and_fro(k):
        return np.array([0.002 * (k % 2), 0.0, 0.03])

    assert most_informative_object(history(10, box=sliding(1.0), cup=to_and_fro)) == "cup"


def test_where_nothing_moved_it_is_the_one_nearest_to_the_hand_when_it_felt_most():
    def tool(k):
        return (0.0, 0.0, 0.3) if k < 6 else (0.5, 0.0, 0.3)

    def force(k):
        return (2.0 if k == 8 else 0.4, 0.0, 0.0)

    objects = {"box": (0.0, 0.0, 0.2), "cup": (0.5, 0.0, 0.1)}
    assert most_informative_object(history(10, tool=tool, force=force, **objects)) == "cup"
    assert most_informative_object(history(7, tool=tool, force=force, **objects)) is None


def test_a_torque_is_not_a_touch():
    twist = np.array([0.0, 0.0, 0.0, 5.0, 0.0, 0.0])
    steps = [
        dataclasses.replace(step, after=dataclasses.replace(step.after, wrench=twist)) for step in history(12, box=TOOL)
    ]
    assert windows(steps, "box") == []
    assert most_informative_object(steps) is None

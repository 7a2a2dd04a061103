import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from histories import history

from coral.contact.control.rollouts import SLEEP
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.world_model.history_replay import HistoryReplay


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

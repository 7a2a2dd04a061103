import itertools

import numpy as np
import pytest

from coral.contact.real_scenes.benchmark_motions import MOTIONS, HeadedTrial, Motion, MotionSample, motion_of
from coral.contact.scene.rigid_transform import body_to_matrix


@pytest.mark.parametrize("kind", MOTIONS)
def test_motions_are_smooth_and_stay_above_the_table(trial, kind):
    motion = Motion(tuple(MOTIONS[kind](HeadedTrial(trial))))
    times = np.arange(0, motion.duration_s, 0.05)
    moments = [motion.at(float(t)) for t in times]
    for before, after in itertools.pairwise(moments):
        assert np.linalg.norm(after.objects["box"][:3, 3] - before.objects["box"][:3, 3]) < 0.02
        assert np.trace(before.objects["box"][:3, :3].T @ after.objects["box"][:3, :3]) > 1 + 2 * np.cos(0.12)
        np.testing.assert_array_equal(after.objects["can"], moments[0].objects["can"])
    lowest = min(
        (trial.corners("box") @ m.objects["box"][:3, :3].T + m.objects["box"][:3, 3])[:, 2].min() for m in moments
    )
    assert lowest > -1e-6
    assert np.linalg.norm(moments[-1].objects["box"] - moments[0].objects["box"]) > 0.1


def sliding(start):
    """A phase of 2 s in which the opening grows by 1 m."""
    return 2.0, lambda share: MotionSample({}, np.eye(4), start + share)


def test_phases_follow_each_other_and_each_begins_and_ends_at_rest():
    motion = Motion((sliding(0.0), sliding(1.0)))
    assert motion.duration_s == 4.0
    opening = [motion.at(time_s).opening_m for time_s in (0.0, 0.5, 1.0, 2.0, 3.0, 4.0)]
    # 3 s^2 - 2 s^3 of the elapsed share
    np.testing.assert_allclose(opening, [0.0, 0.15625, 0.5, 1.0, 1.5, 2.0])


def test_before_and_after_the_motion_everything_is_where_it_begins_and_ends():
    motion = Motion((sliding(0.0), sliding(1.0)))
    assert (motion.at(-1.0).opening_m, motion.at(9.0).opening_m) == (0.0, 2.0)


def test_a_motion_begins_where_the_trial_does(trial):
    start = motion_of(trial).at(0.0)
    for name, item in trial.objects.items():
        np.testing.assert_allclose(start.objects[name], body_to_matrix(item.pose), atol=1e-12)


def test_a_task_without_a_motion_of_its_own_is_picked(trial):
    assert trial.task.name not in MOTIONS
    np.testing.assert_array_equal(
        motion_of(trial).at(4.0).objects["box"],
        Motion(tuple(MOTIONS["pick-box"](HeadedTrial(trial)))).at(4.0).objects["box"],
    )

import warnings
from typing import Literal

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import coral.gym  # noqa: F401  (registers)
from coral.contact.scene.condition import BaseCondition
from coral.contact.tasks import load_task
from coral.errors import InputError
from coral.gym.contact_env import ContactEnv
from coral.interface.task import with_conditions

STILL = np.zeros(7, np.float32)


def moved(axis, amount=1.0):
    action = STILL.copy()
    action[axis] = amount
    return action


@pytest.fixture(scope="module")
def exact():
    env = ContactEnv("pick-box", poses="ground-truth")
    yield env
    env.close()


def test_gymnasiums_checker_has_nothing_to_say():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gymnasium.make("coral/pick-box-v0", poses="ground-truth", disable_env_checker=True)
        check_env(env.unwrapped)
        env.close()


def test_the_seed_decides_the_trial(exact):
    first = exact.reset(seed=1)[0]["object_box"]
    other = exact.reset(seed=2)[0]["object_box"]
    assert np.array_equal(exact.reset(seed=1)[0]["object_box"], first)
    assert not np.array_equal(first, other)


def test_a_given_trial_is_that_of_the_command_line(exact):
    from coral.contact.scene.trial import sample_trial

    seen, info = exact.reset(options={"trial": 7})
    assert info["trial"] == 7
    true = sample_trial(load_task("pick-box"), 7).objects["box"].pose.position
    assert np.allclose(seen["object_box"][:3], true, atol=0.01)


def test_the_target_moves_as_commanded_and_never_far_ahead_of_the_hand(exact):
    first, _ = exact.reset(seed=0)
    before = first["target"]
    for _ in range(5):
        now, reward, terminated, truncated, _ = exact.step(moved(2))
    step = exact.cfg.controller.speed_m_s * exact.cfg.planning.step_s
    assert 0 < now["target"][2] - before[2] <= 5 * step + 1e-6
    assert now["tool"][2] > first["tool"][2]
    assert (reward, terminated, truncated) == (0.0, False, False)
    assert np.linalg.norm(exact._target.position - exact._now.tool.position) <= exact.cfg.controller.lead_m + 0.03


def test_tracked_poses_are_near_the_truth_and_not_the_truth():
    env = ContactEnv("pick-box")
    seen, info = env.reset(seed=0)
    env.close()
    off = np.linalg.norm(seen["object_box"][:3] - info["truth"]["object_box"][:3])
    assert 1e-6 < off < 0.02


class Always(BaseCondition):
    kind: Literal["always"] = "always"

    def monitor(self, trial):
        return lambda truth: True


def test_success_ends_the_episode_with_a_reward():
    task = with_conditions(load_task("pick-box"), [Always(object="box")])
    env = ContactEnv(
        task.model_copy(update={"success": task.success.model_copy(update={"hold_s": 0.02})}), poses="ground-truth"
    )
    env.reset(seed=0)
    _, reward, terminated, truncated, info = env.step(STILL)
    env.close()
    assert (reward, terminated, truncated, info["truth"]["holding"]) == (1.0, True, False, (True,))


def test_the_time_limit_truncates():
    env = ContactEnv(load_task("pick-box").model_copy(update={"time_limit_s": 0.02}), poses="ground-truth")
    env.reset(seed=0)
    _, _, terminated, truncated, _ = env.step(STILL)
    env.close()
    assert (terminated, truncated) == (False, True)


def test_pictures_of_an_episode_show_that_the_hand_moves():
    env = gymnasium.make("coral/pick-box-v0", poses="ground-truth", render_mode="rgb_array")
    recorded = gymnasium.wrappers.RenderCollection(env)
    recorded.reset(seed=0)
    for _ in range(3):
        recorded.step(moved(0))
    first, *_, last = recorded.render()
    env.close()
    assert first.shape == (480, 640, 3)
    assert first.std() > 10
    assert not np.array_equal(first, last)


def test_without_a_render_mode_there_is_no_picture(exact):
    exact.reset(seed=0)
    assert exact.render() is None


@pytest.mark.parametrize(
    ("wrong", "said"), [({"task": "pick-bx"}, "pick-box"), ({"world": "pand"}, "panda"), ({"poses": "true"}, "tracked")]
)
def test_bad_arguments_are_refused(wrong, said):
    with pytest.raises(InputError, match=said):
        ContactEnv(**wrong)


def test_a_bad_trial_is_refused(exact):
    with pytest.raises(InputError, match="trial: found -1"):
        exact.reset(options={"trial": -1})


def test_a_step_before_the_first_reset_is_gymnasiums_error():
    with pytest.raises(gymnasium.error.ResetNeeded):
        ContactEnv("pick-box").step(STILL)

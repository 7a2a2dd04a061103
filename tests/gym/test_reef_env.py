import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import coral.gym  # noqa: F401  (registers)
from coral.errors import InputError
from coral.gym.reef_env import ReefEnv
from coral.reef.simulation.noise import SensorNoiseCfg
from coral.reef.simulation.simulator import SimulatorCfg
from coral.reef.vehicle.camera import CameraCfg

SMALL = CameraCfg(width=16, height=12)
NOISY = SimulatorCfg(camera=SMALL, noise=SensorNoiseCfg(depth_sigma=0.05, drift_xy=0.05))
AHEAD = np.array([1.0, 0.0], np.float32)


def test_gymnasiums_checker_has_nothing_to_say():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gymnasium.make("coral/reef-s1-v0", cfg=SimulatorCfg(camera=SMALL), disable_env_checker=True)
        check_env(env.unwrapped)


def roll(seed, steps=5):
    env = ReefEnv("s1", NOISY)
    found = [env.reset(seed=seed)[0]]
    found += [env.step(AHEAD)[0] for _ in range(steps)]
    return np.stack([np.concatenate([one["depth"].ravel(), one["pose"]]) for one in found])


def test_the_seed_decides_the_noise():
    assert np.array_equal(roll(3), roll(3))
    assert not np.array_equal(roll(3), roll(4))


def test_full_speed_ahead_moves_the_vehicle_and_earns_what_it_sees():
    env = ReefEnv("s1", SimulatorCfg(camera=SMALL))
    first, info = env.reset(seed=0)
    seen = env._coverage()
    total = 0.0
    for _ in range(20):
        now, reward, terminated, truncated, info = env.step(AHEAD)
        total += reward
    moved = np.linalg.norm(now["pose"][:2] - first["pose"][:2])
    assert 0.5 < moved < 1.2  # 2 s at up to 0.6 m/s
    assert total == pytest.approx(env._coverage() - seen - 0.1 * info["truth"]["collisions"])
    assert (terminated, truncated, info["time_s"]) == (False, False, 2.0)


def test_with_drift_the_observed_pose_is_not_the_true_one():
    env = ReefEnv("s1", NOISY)
    env.reset(seed=0)
    for _ in range(20):
        now, *_, info = env.step(AHEAD)
    assert np.abs(now["pose"][:2] - info["truth"]["pose"][:2]).max() > 1e-4


def test_the_time_limit_truncates():
    env = ReefEnv("s1", SimulatorCfg(camera=SMALL), time_limit_s=0.2)
    env.reset(seed=0)
    assert [env.step(AHEAD)[3] for _ in range(2)] == [False, True]


def test_the_picture_has_the_cameras_size():
    env = ReefEnv("s1", SimulatorCfg(camera=SMALL), render_mode="rgb_array")
    env.reset(seed=0)
    assert env.render().shape == (12, 16, 3)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"world": "s11"}, "s1"),
        ({"render_mode": "human"}, "rgb_array"),
        ({"control_period_s": 5.0}, "control_period_s"),
    ],
)
def test_bad_arguments_are_refused(wrong, said):
    with pytest.raises(InputError, match=said):
        ReefEnv(**wrong)


@pytest.mark.parametrize("action", [[np.nan, 0.0], [0.0, np.inf], [0.5], "fast"])
def test_an_action_that_is_no_two_numbers_is_refused_and_changes_nothing(action):
    env = ReefEnv("s1", SimulatorCfg(camera=SMALL))
    env.reset(seed=1)
    with pytest.raises(ValueError, match=r"action: found|could not convert"):
        env.step(action)
    observation = env.step(np.zeros(2, np.float32))[0]
    assert np.isfinite(observation["pose"]).all()

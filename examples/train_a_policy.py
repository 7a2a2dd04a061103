"""A small policy for a reef, by the cross-entropy method: a linear map from the depth picture to a command."""

import gymnasium
import numpy as np

import coral.gym  # noqa: F401 - registers the environments

ROUNDS, POPULATION, ELITE, STEPS = 2, 6, 2, 60
rng = np.random.default_rng(0)


def features(seen) -> np.ndarray:
    """Return nearness to the left, ahead and right, oysters to the left and right, and a one."""
    near = [1.0 / np.clip(np.nanmin(part), 0.3, 10.0) for part in np.array_split(seen["depth"], 3, axis=1)]
    oysters = [np.mean(part == 1) for part in np.array_split(seen["labels"], 2, axis=1)]
    return np.array([*near, *oysters, 1.0])


def episode(env, weights: np.ndarray) -> float:
    """Return the reward of one episode."""
    seen, _ = env.reset(seed=0)
    total = 0.0
    for _ in range(STEPS):
        seen, reward, ended, out_of_time, _ = env.step(np.tanh(weights @ features(seen)).astype(np.float32))
        total += float(reward)
        if ended or out_of_time:
            break
    return total


env = gymnasium.make("coral/reef-l1-v0")
mean, spread = np.zeros((2, 6)), np.ones((2, 6))
mean[0, -1] = 1.0  # begin by driving ahead
for number in range(ROUNDS):
    tried = [mean + spread * rng.standard_normal(mean.shape) for _ in range(POPULATION)]
    rewards = np.array([episode(env, weights) for weights in tried])
    best = np.array([tried[index] for index in np.argsort(rewards)[-ELITE:]])
    mean, spread = best.mean(0), best.std(0) + 0.1
    print(f"round {number}: best {rewards.max():.2f}, mean {rewards.mean():.2f}")

"""Two advisors on the same reefs: the paired difference of what they inspect, with a bootstrap interval over reefs."""

import numpy as np

import coral

REEFS = ("l1", "s1", "o1")
CFG = {"time_limit_s": 20, "latency": "fixed:5"}


def inspected(advisor: str) -> np.ndarray:
    """Return the share of the oysters seen from near, reef by reef. Nobody decides for an advisor that fails."""
    results = [coral.run_mission(reef, advisor=advisor, fallback="hold", cfg=CFG) for reef in REEFS]
    return np.array([result.metrics["inspected"] for result in results])


rules, errs = inspected("heuristic"), inspected("sloppy:1:heuristic")
difference = errs - rules
rng = np.random.default_rng(0)
means = [rng.choice(difference, len(difference)).mean() for _ in range(2000)]
low, high = np.quantile(means, (0.025, 0.975))
print(f"rules {rules.mean():.2f}, the same with plausible mistakes {errs.mean():.2f}")
print(f"difference {difference.mean():+.2f}, 95 % interval {low:+.2f} to {high:+.2f}")
print("three reefs are few: `coral reef bench` makes the same table over many")

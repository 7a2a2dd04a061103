"""The repairman's problem: the order in which places wait least, by their worth (exact, for a few places)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def delays_from(between_s: NDArray[np.float64], worth: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the least mean delay (s), Shape=(N,), of the other places from each place, by dynamic programming.

    A place that is visited at time t is delayed by t; the mean is by worth, Shape=(N,). `between_s`, Shape=(N, N), are
    travelling times (s).
    """
    n = len(between_s)
    full = (1 << n) - 1
    best = np.zeros((1 << n, n))  # best[S, i]: least total worth x delay of the places S still to visit, from i
    waiting = np.array([sum(worth[j] for j in range(n) if subset >> j & 1) for subset in range(full + 1)])
    for subset in range(1, full + 1):
        members = [j for j in range(n) if subset >> j & 1]
        rest = np.array([best[subset ^ (1 << j), j] for j in members])
        best[subset] = np.min(between_s[:, members] * waiting[subset] + rest, axis=1)
    return np.asarray([best[full ^ (1 << i), i] / waiting[full] for i in range(n)], np.float64)


def order_from(first: int, between_s: NDArray[np.float64], worth: NDArray[np.float64]) -> list[int]:
    """Return the order that makes the mean delay least when one place comes first; see `delays_from`."""
    order, rest = [first], [k for k in range(len(worth)) if k != first]
    while rest:
        onward = delays_from(between_s[np.ix_(rest, rest)], worth[rest])
        best = int(np.argmin(between_s[order[-1], rest] + onward))
        order.append(rest.pop(best))
    return order

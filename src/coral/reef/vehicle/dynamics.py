"""Parameters of the BlueROV2, and the constants of its equations of motion.

Body frame FLU (x forward, y left, z up), origin at the centre of gravity. Masses, inertia and drag are positive
magnitudes; the equations carry the signs. The depth controller holds depth, roll and pitch.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from coral.config import Positive


@dataclass(frozen=True, kw_only=True)
class Thrusters:
    """T200 thrusters of the Heavy frame that act in the plane: four horizontal ones at 45 degrees (von Benzon 2022)."""

    x_m: float = 0.156
    y_m: float = 0.111
    lag_s: Positive = 0.0287
    """First-order lag of the thrust: the mean delay (9258-6136)/108700 s of the identified transfer function
    (6136s+108700)/(s^3+89s^2+9258s+108700). Its other modes (above 13 rad/s) are faster than the velocity loop."""


class Planar(NamedTuple):
    """Constants of the planar model (surge, sway, yaw), as the kernels take them."""

    m11: float
    m22: float
    m66: float
    du: float
    dv: float
    dr: float
    duu: float
    dvv: float
    drr: float
    thrust_max: float
    """Largest force of one thruster (N)."""
    force_arm: float
    """Surge or sway force per newton of each of the four thrusters: 4 cos 45."""
    moment_arm: float
    """Yaw moment per newton of each of the four thrusters: 4 (x + y) cos 45 (m)."""


def thrust_n(u: NDArray[np.float64] | float) -> NDArray[np.float64]:
    """Compute the static thrust (N) of a T200 at the input u in [-1, 1] (von Benzon 2022); 30.4 N at u = 1."""
    a = np.clip(np.asarray(u, dtype=np.float64), -1.0, 1.0)
    return np.asarray(a * (8.9 + a**2 * (176.0 + a**2 * (-404.1 + a**2 * (389.9 - 140.3 * a**2)))))


THRUST_MAX_N = float(thrust_n(1.0))


def planar(thrusters: Thrusters, thrust_max_n: float = THRUST_MAX_N) -> Planar:
    """Return the planar constants of the BlueROV2 Heavy (von Benzon et al. 2022); masses include the added mass."""
    cos45 = math.sqrt(0.5)
    return Planar(
        13.5 + 6.36,
        13.5 + 7.12,
        0.37 + 0.222,
        13.7,
        0.0,
        0.0,
        141.0,
        217.0,
        1.5,
        thrust_max_n,
        4.0 * cos45,
        4.0 * cos45 * (thrusters.x_m + thrusters.y_m),
    )

"""Parameters of the BlueROV2, and the constants of its equations of motion.

Body frame FLU (x forward, y left, z up), origin at the centre of gravity. Mass, inertia and drag values are positive
magnitudes; the equations carry the signs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from coral.config import Positive

GRAVITY_M_S2 = 9.81
WATER_KG_M3 = 1000.0

Six = tuple[float, float, float, float, float, float]


@dataclass(frozen=True, kw_only=True)
class Parameters:
    """Rigid-body and hydrodynamic parameters of a vehicle. Six-vectors: surge, sway, heave, roll, pitch, yaw."""

    mass_kg: float
    volume_m3: float
    inertia_kg_m2: tuple[float, float, float]
    added_mass: Six
    linear_drag: Six
    quadratic_drag: Six
    cb_above_cg_m: float


BLUEROV2_HEAVY = Parameters(
    mass_kg=13.5,
    volume_m3=0.0134,
    inertia_kg_m2=(0.26, 0.23, 0.37),
    added_mass=(6.36, 7.12, 18.68, 0.189, 0.135, 0.222),
    linear_drag=(13.7, 0.0, 33.0, 0.0, 0.8, 0.0),
    quadratic_drag=(141.0, 217.0, 190.0, 1.19, 0.47, 1.5),
    cb_above_cg_m=0.01,
)
"""Von Benzon et al. 2022."""


@dataclass(frozen=True, kw_only=True)
class Thrusters:
    """T200 thrusters of the Heavy frame: four horizontal ones at 45 degrees and four vertical (von Benzon 2022)."""

    x_m: float = 0.156
    y_m: float = 0.111
    below_cg_m: float = 0.085
    vertical_x_m: float = 0.12
    vertical_y_m: float = 0.218
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
    """Return the planar constants of the BlueROV2 Heavy (m11, m22 and m66 include the added mass)."""
    p = BLUEROV2_HEAVY
    cos45 = math.sqrt(0.5)
    return Planar(
        p.mass_kg + p.added_mass[0],
        p.mass_kg + p.added_mass[1],
        p.inertia_kg_m2[2] + p.added_mass[5],
        p.linear_drag[0],
        p.linear_drag[1],
        p.linear_drag[5],
        p.quadratic_drag[0],
        p.quadratic_drag[1],
        p.quadratic_drag[5],
        thrust_max_n,
        4.0 * cos45,
        4.0 * cos45 * (thrusters.x_m + thrusters.y_m),
    )


class SixDof(NamedTuple):
    """Constants of the six-degree-of-freedom model, as the kernels take them. Arrays have Shape=(6,)."""

    inertia: NDArray[np.float64]
    """Diagonal of the mass matrix, rigid body plus added mass (kg, kg m^2)."""
    linear_drag: NDArray[np.float64]
    quadratic_drag: NDArray[np.float64]
    weight_n: float
    buoyancy_n: float
    cb_above_cg_m: float
    thrust_max: float
    horizontal: NDArray[np.float64]
    """(4 cos 45, 4 (x+y) cos 45, z of the horizontal thrusters)."""
    vertical: NDArray[np.float64]
    """(4, 4 y, 4 x) of the vertical thrusters."""


def six_dof(thrusters: Thrusters, thrust_max_n: float = THRUST_MAX_N) -> SixDof:
    """Return the six-degree-of-freedom constants of the BlueROV2 Heavy."""
    p, t = BLUEROV2_HEAVY, thrusters
    rigid = np.array([p.mass_kg] * 3 + list(p.inertia_kg_m2))
    flat = planar(t)
    return SixDof(
        rigid + np.array(p.added_mass),
        np.array(p.linear_drag),
        np.array(p.quadratic_drag),
        p.mass_kg * GRAVITY_M_S2,
        p.volume_m3 * WATER_KG_M3 * GRAVITY_M_S2,
        p.cb_above_cg_m,
        thrust_max_n,
        np.array([flat.force_arm, flat.moment_arm, -t.below_cg_m]),
        np.array([4.0, 4.0 * t.vertical_y_m, 4.0 * t.vertical_x_m]),
    )

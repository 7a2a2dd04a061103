"""DDP-MPPI: sampling-based control whose dynamics become coarser along the rollout (paper III-E, Alg. 3)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from coral.config import Count, Fraction, Positive, TimeStep
from coral.errors import InputError
from coral.mppi.weights import softmax_weights, weighted_mean
from coral.reef.drive.controller_kernels import (
    RolloutScene,
    Schedule,
    clearance_at,
    hull_is_free,
    rollout,
)
from coral.reef.drive.cost_terms import COSTS, CostCfg, Scales
from coral.reef.map.costfield import CostField
from coral.reef.vehicle.dynamics import planar
from coral.reef.vehicle.response import Trailing, VehicleResponse
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleState

Array = NDArray[np.float64]

NOTHING_TRAILS = Trailing()
NO_FEASIBLE = "no feasible rollout"
NOT_FINITE = "the state is not finite"


@dataclass(frozen=True, kw_only=True)
class MppiCfg:
    """Settings of DDP-MPPI. Values are those of paper IV-F unless noted."""

    n_rollouts: Annotated[int, Field(ge=10)] = 400
    n_steps: Annotated[int, Field(ge=2)] = 10
    horizon_s: Positive = 5.0
    """T. The paper gives none. With 5 s and p = 1.7 the first interval of Eq. 10 is the control period, 0.1 s."""
    p: Positive = 1.7
    """Exponent of Eqs. 10 and 11. The paper gives none; 1.7 fits the intervals of the published DDP planner."""
    uniform: bool = False
    """True is the ablation without DDP: equal intervals, all boundary points at every step."""
    n_points: Count = 32
    """n of Eq. 11. The points are 5.9 cm apart on the hull, about one map cell."""
    margin_m: float = 0.08
    """Clearance that a rollout must keep: one map cell of position error, and the thrust lag that rollouts omit. A
    mission adds what its position loses while an obstacle is out of the picture (`localization.drift_xy`)."""
    substep_near_s: TimeStep = 0.05
    substep_far_s: TimeStep = 0.2
    """Integration steps of the first and of the last interval. Between them the step grows with the interval."""
    sensing_m: float = 4.0
    sigma_v: float = 0.05
    sigma_omega: float = 0.05
    temperature: Positive = 0.03
    """lambda, in units of the cost, which differs by about 1 between standing and full progress. The paper gives none.
    With 0.1 the slow half of the samples weighs too much: 0.42 m/s in clutter instead of 0.50."""
    warm_fraction: Fraction = 0.35
    """Share of rollouts sampled around the previous solution."""
    guided_fraction: Fraction = 0.15
    """Share of rollouts that steer down the cost-to-go: with sigma = 0.05 alone, samples stay near the nominal for a
    second. The remaining rollouts hold a constant from the dynamic window; half of them brake part of the way."""
    recovery_speed_m_s: float = 0.2
    """Reverse speed, tried only when nothing else is feasible: the camera looks forward."""
    hold_m: float = 0.3
    """Within this distance of the goal the vehicle holds its position."""
    costs: CostCfg = field(default_factory=CostCfg)
    keep_rollouts: bool = False

    def __post_init__(self) -> None:
        shares = self.warm_fraction + self.guided_fraction
        if shares > 0.95:
            raise InputError("controller", "warm_fraction + guided_fraction", f"{shares:g}", "at most 0.95 together")
        taken = 2 + round(self.warm_fraction * self.n_rollouts) + round(self.guided_fraction * self.n_rollouts)
        if taken > self.n_rollouts:  # two more: one stands still, one repeats the previous plan
            raise InputError("controller", "n_rollouts", self.n_rollouts, f"at least {taken} for these shares")


@dataclass(frozen=True)
class Plan:
    """Result of the controller at one tick."""

    command: tuple[float, float]
    """Forward speed (m/s) and yaw rate (rad/s) to execute now."""
    ok: bool
    """Whether a feasible rollout was found. Otherwise `failure` gives the reason and the command is safe."""
    failure: str
    path: Array
    """Poses of the plan in the world. Shape=(T + 1, 3)."""
    rollouts: Array | None = None
    """All rollouts, Shape=(K, T + 1, 3), and whether each is `feasible`, Shape=(K,). None unless asked for."""
    feasible: NDArray[np.bool_] | None = None


def intervals(horizon_s: float, n_steps: int, p: float) -> Array:
    """Compute Eq. 10: Delta_t = T [((t+1)/n)^p - (t/n)^p] (s). They add up to T. Shape=(n,)."""
    edges = horizon_s * (np.arange(n_steps + 1) / n_steps) ** p
    return np.asarray(np.diff(edges))


def boundary_points(n: int, n_steps: int, p: float) -> NDArray[np.int64]:
    """Compute Eq. 11: N_t = n (1 - (t/T)^p), rounded up. Shape=(n_steps,)."""
    return np.asarray(np.ceil(n * (1.0 - (np.arange(n_steps) / n_steps) ** p)), dtype=np.int64)


def schedule(cfg: MppiCfg, response: VehicleResponse) -> Schedule:
    """Compute interval, integration steps and boundary points of every step of the horizon, and how velocities follow.

    The delay of the response is not in it: plan from the state in which the command will find the vehicle.
    """
    n = cfg.n_steps
    dt = intervals(cfg.horizon_s, n, 1.0 if cfg.uniform else cfg.p)
    points = np.full(n, cfg.n_points) if cfg.uniform else boundary_points(cfg.n_points, n, cfg.p)
    h_max = np.linspace(cfg.substep_near_s, cfg.substep_near_s if cfg.uniform else cfg.substep_far_s, n)
    substeps = np.maximum(1, np.ceil(dt / h_max - 1e-9)).astype(np.int64)
    h = dt / substeps
    rate = -np.expm1(-h / response.surge_lag_s) / h
    yaw_rate = -np.expm1(-h / response.yaw_lag_s) / h
    circle = np.zeros((n, cfg.n_points, 2))
    for t in range(n):
        angle = 2.0 * math.pi * np.arange(points[t]) / points[t]
        circle[t, : points[t]] = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return Schedule(dt, substeps, rate, yaw_rate, points, circle, response.trail, -np.expm1(-h / response.trail_lag_s))


def shift_matrix(dt: Array, by_s: float) -> Array:
    """Return the matrix that shifts a piecewise-constant sequence on the intervals `dt` by `by_s` (s). Shape=(T, T).

    Row t holds the shares of the old intervals in the new interval t. Beyond the old end the last value is held.
    """
    edges = np.concatenate([[0.0], np.cumsum(dt)])
    n = len(dt)
    shares = np.zeros((n, n))
    old_end = edges[1:].copy()
    old_end[-1] = np.inf
    for t in range(n):
        low, high = edges[t] + by_s, edges[t + 1] + by_s
        overlap = np.minimum(high, old_end) - np.maximum(low, edges[:-1])
        shares[t] = np.maximum(overlap, 0.0) / (high - low)
    return shares


class DdpMppi:
    """Minimise over (v, omega) the weighted sum of `COSTS` on a rollout, subject to clearance >= margin at each step.

    The commands are constant on the intervals of Eq. 10. Each tick samples K sequences, rolls them out over the
    vehicle's dynamics, drops those that collide, and averages the others with weights softmax(-cost / lambda). The mean
    is the warm start of the next tick. By default commands are followed as by the simulated vehicle.
    """

    def __init__(
        self,
        cfg: MppiCfg | None = None,
        vehicle: VehicleCfg | None = None,
        rng: np.random.Generator | None = None,
        *,
        control_period_s: float = 0.1,
        response: VehicleResponse | None = None,
    ) -> None:
        self.cfg = cfg = cfg or MppiCfg()
        self.vehicle = vehicle = vehicle or VehicleCfg()
        self.response = response = response or VehicleResponse.of_vehicle(vehicle)
        self._rng = rng or np.random.default_rng(0)
        self._model = planar(vehicle.thrusters, vehicle.thrust_max_n)
        self.schedule = schedule(cfg, response)
        self._shift = shift_matrix(self.schedule.dt, control_period_s)
        self._weights = cfg.costs.weights
        self._nominal = np.zeros((cfg.n_steps, 2))
        self._executed = np.zeros(2)
        k = cfg.n_rollouts
        self._path = np.empty((k, cfg.n_steps + 1, 3))
        self._costs = np.empty((k, len(COSTS)))
        self._feasible = np.empty(k, np.bool_)
        self._n_guided = round(cfg.guided_fraction * k)
        self._n_warm = round(cfg.warm_fraction * k)
        self._guide = np.zeros(k)
        self._guide[2 : 2 + self._n_guided] = np.resize(
            np.linspace(1.0, 0.25, 5) * vehicle.max_speed_m_s, self._n_guided
        )
        self._free = np.zeros(k)
        self._controls = np.empty((k, cfg.n_steps, 2))

    def reset(self) -> None:
        """Forget the previous solution, as after a new goal in another direction."""
        self._nominal[:] = 0.0
        self._executed[:] = 0.0

    def warm_start(self) -> Array:
        """Return the previous solution, shifted by one control period. Shape=(T, 2)."""
        return np.asarray(self._shift @ self._nominal)

    def plan(
        self,
        state: VehicleState,
        cost_field: CostField,
        distance_map: NDArray[np.float32],
        *,
        cell_m: float = 0.05,
        trailing: Trailing = NOTHING_TRAILS,
    ) -> Plan:
        """Compute the command of this tick.

        `distance_map`, Shape=(H, W), float32, is the distance (m) to the nearest known obstacle, inf without any; its
        cell (0, 0) lies at the world's origin. `trailing` is the part of the velocity that follows slowly.
        """
        if not all(map(math.isfinite, state)):
            return self._stop(VehicleState(0.0, 0.0, 0.0), NOT_FINITE, ok=False)
        if not cost_field.ok:
            return self._stop(state, cost_field.failure, ok=False)
        if math.hypot(cost_field.target[0] - state.x, cost_field.target[1] - state.y) < self.cfg.hold_m:
            return self._stop(state, "", ok=True)
        start = np.array([*state, *trailing], dtype=np.float64)
        scene = self._scene(start, cost_field, distance_map, cell_m)
        controls = self._sample()
        total = self._evaluate(start, controls, self._guide, scene)
        kept = (self._path.copy(), self._feasible.copy()) if self.cfg.keep_rollouts else (None, None)
        failure = ""
        if not self._feasible.any():
            failure = NO_FEASIBLE
            controls = self._sample_recovery()
            total = self._evaluate(start, controls, self._free, scene)
            if not self._feasible.any():
                return self._stop(state, failure, ok=False)
        weights = softmax_weights(total, self.cfg.temperature)
        mean = weighted_mean(weights, controls)
        path, free = self._one(start, mean, scene)
        if not free:
            best = int(np.argmin(total))
            mean, path = controls[best].copy(), self._path[best].copy()
        self._nominal = mean
        self._executed = mean[0].copy()
        return Plan(
            command=(float(mean[0, 0]), float(mean[0, 1])),
            ok=not failure,
            failure=failure,
            path=path,
            rollouts=kept[0],
            feasible=kept[1],
        )

    def _scene(self, start: Array, field: CostField, distance: NDArray[np.float32], cell_m: float) -> RolloutScene:
        cfg, hull, margin = self.cfg, self.vehicle.hull_radius_m, self.cfg.margin_m
        scene = RolloutScene(
            distance,
            cell_m,
            field.value,
            field.cell_m,
            hull,
            margin,
            cfg.sensing_m,
            Scales(
                cfg.costs.soft_m,
                hull,
                self.vehicle.max_speed_m_s * cfg.horizon_s,
                self.vehicle.max_speed_m_s,
                self.vehicle.max_yaw_rate_rad_s,
            ),
        )
        # A robot that is already closer than the margin (a new obstacle, drift) must be able to leave: it may go
        # anywhere that is not closer still, except for its stopping distance and the blur of the map's cells.
        slack = 0.5 * cell_m
        circle = self.schedule.circle[0]
        x, y = float(start[0]), float(start[1])
        near = clearance_at(distance, cell_m, x, y)
        if near > hull + margin + 2.0 * cell_m:
            return scene
        spare = min(clearance_at(distance, cell_m, x + hull * c, y + hull * s) for c, s in circle) - slack
        if near < hull:  # something is mapped within the hull, all of whose boundary may be clear of it
            spare = 0.0
        if spare >= margin:
            return scene
        if spare > 0.0:
            stopping = math.hypot(start[3], start[4]) * self.response.surge_lag_s
            least = scene._replace(margin_m=max(spare - stopping, 0.0))
            if self._stands(least, x, y):
                return least
        least = scene._replace(margin_m=0.0, hull_m=max(near - 2.0 * slack, 0.05))
        if self._stands(least, x, y):
            return least
        # With this the blur of the two cells compared, half a diagonal each, cannot matter.
        return scene._replace(margin_m=0.0, hull_m=max(near - 3.0 * slack, 0.05))

    def _stands(self, scene: RolloutScene, x: float, y: float) -> bool:
        """Check whether a robot that stays at (x, y) is feasible: each step checks other points of the boundary."""
        steps = zip(self.schedule.circle, self.schedule.points, strict=True)
        return all(hull_is_free(scene, x, y, points, n) for points, n in steps)

    def _sample(self) -> Array:
        """Sample control sequences: stop, previous plan, guided, warm-started, dynamic window. Shape=(K, T, 2).

        The first five guided ones have no noise; what is not guided keeps to the limits.
        """
        cfg, v_max, w_max = self.cfg, self.vehicle.max_speed_m_s, self.vehicle.max_yaw_rate_rad_s
        n, warm, warm_start = cfg.n_steps, 2 + self._n_guided, self.warm_start()
        first = warm + self._n_warm
        n_window = cfg.n_rollouts - first
        controls = self._rng.standard_normal(out=self._controls)
        v, w = controls[..., 0], controls[..., 1]
        v *= cfg.sigma_v
        w *= cfg.sigma_omega
        controls[0], controls[1], controls[2 : min(warm, 7)] = 0.0, warm_start, 0.0
        controls[warm:first] += warm_start
        v[first:] += self._rng.uniform(0.0, v_max, n_window)[:, None]
        w[first:] += self._rng.uniform(-w_max, w_max, n_window)[:, None]
        # Half of them brake from a random step on: in clutter, few constants stay feasible over the whole horizon.
        brake = self._rng.integers(1, n, n_window)
        brake[::2] = n
        controls[first:][np.arange(n)[None, :] >= brake[:, None]] = 0.0
        for free in (slice(0, 2), slice(warm, None)):
            np.clip(v[free], 0.0, v_max, out=v[free])
            np.clip(w[free], -w_max, w_max, out=w[free])
        return controls

    def _sample_recovery(self) -> Array:
        """Sample slow constants, reverse included, that stop at a random step; the first stands. Shape=(K, T, 2)."""
        cfg, slow, w_max = self.cfg, self.cfg.recovery_speed_m_s, self.vehicle.max_yaw_rate_rad_s
        k, n = cfg.n_rollouts, cfg.n_steps
        constants = np.stack([self._rng.uniform(-slow, slow, k), self._rng.uniform(-w_max, w_max, k)], axis=1)
        controls = np.repeat(constants[:, None, :], n, axis=1)
        brake = self._rng.integers(1, n + 1, k)
        controls[np.arange(n)[None, :] >= brake[:, None]] = 0.0
        controls[0] = 0.0
        return controls

    def _evaluate(self, start: Array, controls: Array, guide: Array, scene: RolloutScene) -> Array:
        """Compute the total cost of each rollout, inf if it collides. Shape=(K,)."""
        rollout(
            start, self._executed, controls, guide, self.schedule, scene, self._model,
            self._path, self._costs, self._feasible,
        )  # fmt: skip
        return np.asarray(np.where(self._feasible, self._costs @ self._weights, np.inf))

    def _one(self, start: Array, controls: Array, scene: RolloutScene) -> tuple[Array, bool]:
        """Return the path and the feasibility of one sequence."""
        path, costs, free = np.empty((1, len(controls) + 1, 3)), np.empty((1, len(COSTS))), np.empty(1, np.bool_)
        rollout(
            start, self._executed, controls[None].copy(), np.zeros(1), self.schedule, scene, self._model,
            path, costs, free,
        )  # fmt: skip
        return path[0], bool(free[0])

    def _stop(self, state: VehicleState, failure: str, *, ok: bool) -> Plan:
        """Return a plan that brakes and stays."""
        self.reset()
        return Plan((0.0, 0.0), ok, failure, np.tile(np.array(state[:3], np.float64), (self.cfg.n_steps + 1, 1)))

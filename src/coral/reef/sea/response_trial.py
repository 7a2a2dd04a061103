"""The calibration drive: steps of speed and yaw rate, from which a vehicle's response is identified."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from coral.errors import RunError
from coral.reef.sea.link import VehicleLink
from coral.reef.vehicle.response import DelayedCommands, VehicleResponse
from coral.reef.vehicle.vehicle import VehicleState
from coral.reef.world.geometry import Pose

PERIOD_S = 0.1
AHEAD_S = 1.0
"""The margin is the error of positions predicted so far ahead: a vehicle at cruise speed stands by then."""
SHARE = 0.95
"""Share of the predictions that the margin covers."""
FEWEST = 100
"""With fewer new velocities than this nothing is identified."""
Array = NDArray[np.float64]

LAGS_S = np.arange(0.05, 1.01, 0.05)
DELAYS_S = np.arange(0.0, 0.51, 0.05)
TRAIL_LAGS_S = np.array([1.0, 1.5, 2.0, 3.0, 4.0, 6.0])
MOST_SAMPLES = 600
"""More measurements than this are thinned out for the fit."""
LEAST_GAIN = 0.2
"""A vehicle that reaches less of what is asked does not follow."""


@dataclass(frozen=True)
class Leg:
    """One step of the drive."""

    forward_m_s: float
    yaw_rate_rad_s: float
    seconds: float


def legs(speed_m_s: float, yaw_rate_rad_s: float) -> tuple[Leg, ...]:
    """Return the drive, within 5 m: straight steps there and back, turns on the spot, curves to both sides."""
    half = Leg(0.0, yaw_rate_rad_s, math.pi / yaw_rate_rad_s)
    back = Leg(0.0, -yaw_rate_rad_s, math.pi / yaw_rate_rad_s)
    stand, run = Leg(0.0, 0.0, 4.0), Leg(speed_m_s, 0.0, 5.0)
    slow, back_off = Leg(0.6 * speed_m_s, 0.0, 5.0), Leg(-0.4 * speed_m_s, 0.0, 4.0)
    left, right = (Leg(speed_m_s, side * 0.7 * yaw_rate_rad_s, 4.0) for side in (1.0, -1.0))
    return (stand, run, stand, half, stand, run, stand, back, stand, slow, stand, half, stand, slow, stand,
            run, left, run, stand, back_off, stand, back, stand, run, right, run, stand, back_off, stand)  # fmt: skip


@dataclass
class TrialLog:
    """What was commanded and measured, all times on one clock (s)."""

    commands: list[tuple[float, float, float]] = field(default_factory=list)
    """Time, forward speed, yaw rate of every set-point."""
    velocities: list[tuple[float, float, float, float]] = field(default_factory=list)
    """Stamp and velocity (m/s forward, m/s left, rad/s left) of every new measurement."""
    poses: list[tuple[float, float, float, float]] = field(default_factory=list)
    """Stamp and pose of every new measurement."""


def drive(
    link: VehicleLink,
    plan: tuple[Leg, ...],
    depth_m: float,
    clock: Callable[[], float],
    sleep: Callable[[float], None],
    stopped: Callable[[], str] = lambda: "",
) -> TrialLog:
    """Drive the legs with an armed vehicle at a depth (m); record what it did.

    `clock` is that of the vehicle's stamps (s); stopped() returns why the drive must end, or "".

    Raises:
        RunError: Somebody took over, the position was lost, or the operator stopped the drive.
    """
    log, due = TrialLog(), clock()
    for forward, yaw_rate in _setpoints(plan):
        link.command(forward, yaw_rate, depth_m)
        log.commands.append((clock(), forward, yaw_rate))
        due += PERIOD_S
        while clock() < due - 1e-6:
            _note(link, log)
            sleep(min(0.02, max(due - clock(), 0.0)))
        report = link.report()
        lost = not report.has_position or clock() - report.pose_stamp_s > 1.0
        why = stopped() or ("taken over" if report.manual_override or not report.armed else "")
        if why or lost:
            link.command(0.0, 0.0, depth_m)
            raise RunError(f"the calibration drive ended early: {why or 'the position was lost'}")
    return log


def _setpoints(plan: tuple[Leg, ...]) -> Iterator[tuple[float, float]]:
    for leg in plan:
        for _ in range(round(leg.seconds / PERIOD_S)):
            yield leg.forward_m_s, leg.yaw_rate_rad_s


def _note(link: VehicleLink, log: TrialLog) -> None:
    report = link.report()
    if report.velocity is not None and (not log.velocities or report.velocity_stamp_s > log.velocities[-1][0]):
        log.velocities.append((report.velocity_stamp_s, *report.velocity))
    if report.pose is not None and (not log.poses or report.pose_stamp_s > log.poses[-1][0]):
        log.poses.append((report.pose_stamp_s, *report.pose))


def identify(log: TrialLog) -> tuple[VehicleResponse, StepResponse, StepResponse]:
    """Return the response of the vehicle, and the fits of its forward speed and of its yaw rate.

    Raises:
        RunError: Too little was measured, or the vehicle did not follow.
    """
    if min(len(log.velocities), len(log.poses)) < FEWEST:
        raise RunError(f"{len(log.velocities)} new velocities came during the drive, where {FEWEST} are needed")
    sent, seen = np.array(log.commands), np.array(log.velocities)
    surge = fit_step_response(seen[:, 0], seen[:, 1], sent[:, 0], sent[:, 1], trails=True)
    yaw = fit_step_response(seen[:, 0], seen[:, 3], sent[:, 0], sent[:, 2], trails=False)
    response = VehicleResponse(
        surge_gain=round(surge.gain, 3),
        surge_lag_s=round(surge.lag_s, 3),
        surge_delay_s=round(surge.delay_s, 3),
        trail=round(surge.trail, 3),
        trail_lag_s=round(surge.trail_lag_s, 3),
        yaw_gain=round(yaw.gain, 3),
        yaw_lag_s=round(yaw.lag_s, 3),
        yaw_delay_s=round(yaw.delay_s, 3),
    )
    margin_m = float(np.quantile(prediction_errors(response, log), SHARE))
    return replace(response, margin_m=round(margin_m, 3)), surge, yaw


def prediction_errors(response: VehicleResponse, log: TrialLog) -> NDArray[np.float64]:
    """Predict the position `AHEAD_S` after each command, with the commands that followed. Errors (m), Shape=(N,)."""
    seen, poses = np.array(log.velocities), np.array(log.poses)
    heading = np.unwrap(poses[:, 3])
    ahead, errors = round(AHEAD_S / PERIOD_S), []
    wanted = [(response.surge_gain * v, response.yaw_gain * w) for _, v, w in log.commands]
    under_way = DelayedCommands(response, PERIOD_S)
    for k in range(len(log.commands) - ahead):
        t = log.commands[k][0]
        if k >= ahead:
            now = _interpolated(t, poses[:, 0], poses[:, 1], poses[:, 2], heading)
            state = VehicleState(*now, *_interpolated(t, seen[:, 0], seen[:, 1], seen[:, 2], seen[:, 3]))
            trailing = under_way.trailing(state)
            for j in range(k, k + ahead):
                surge = wanted[max(0, j - round(response.surge_delay_s / PERIOD_S))][0]
                yaw = wanted[max(0, j - round(response.yaw_delay_s / PERIOD_S))][1]
                step_s = log.commands[j + 1][0] - log.commands[j][0]
                state, trailing = response.advance(state, trailing, (surge, yaw), step_s)
            true = _interpolated(log.commands[k + ahead][0], poses[:, 0], poses[:, 1], poses[:, 2], heading)
            errors.append(math.dist(state[:2], true[:2]))
        under_way.note(wanted[k])
    return np.array(errors)


def _interpolated(t: float, at: NDArray[np.float64], *values: NDArray[np.float64]) -> Pose:
    return Pose(*(float(np.interp(t, at, value)) for value in values))


@dataclass(frozen=True, kw_only=True)
class StepResponse:
    """y(t) is the command of t - delay behind a lag; a share `trail` of it is behind a longer one."""

    gain: float
    lag_s: float
    delay_s: float
    trail: float = 0.0
    trail_lag_s: float = 2.0
    error: float
    """Root mean square of what the model does not explain, in units of y."""


def lagged(t: Array, at: Array, command: Array, lag_s: float, delay_s: float) -> Array:
    """Return a command behind a delay (s) and a first-order lag (s), at the times `t` (s). Shape=(N,).

    `command` is what it changed to at the times `at` (s), Shape=(M,); 0 before.
    """
    since = np.maximum(t[:, None] - at[None, :] - delay_s, 0.0)
    return np.asarray(-np.expm1(-since / lag_s) @ np.diff(command, prepend=0.0))


def fit_step_response(t: Array, y: Array, at: Array, command: Array, *, trails: bool) -> StepResponse:
    """Find the least-squares response: a grid over lags and delay, gain and share in closed form.

    `y` are the speeds measured at `t` (s), Shape=(N,), `command` the set-points given at `at` (s), Shape=(M,).
    `trails`: a share may trail behind.

    Raises:
        RunError: The vehicle did not follow.
    """
    changes = np.diff(command, prepend=0.0) != 0.0
    at, command = at[changes], command[changes]
    thin = max(1, len(t) // MOST_SAMPLES)
    t, y = t[::thin], y[::thin]
    best = StepResponse(gain=0.0, lag_s=0.25, delay_s=0.0, error=float("inf"))
    for delay in DELAYS_S:
        slow = [lagged(t, at, command, lag, delay) for lag in (TRAIL_LAGS_S if trails else ())]
        for lag in LAGS_S:
            fast = lagged(t, at, command, lag, delay)
            for trail_lag, shapes in [
                (2.0, (fast,)),
                *((T, (fast, s)) for T, s in zip(TRAIL_LAGS_S, slow, strict=False)),
            ]:
                found = np.linalg.lstsq(np.stack(shapes, axis=1), y, rcond=None)[0]
                if np.any(found <= 0.0):
                    continue
                error = float(np.sqrt(np.mean((y - np.stack(shapes, axis=1) @ found) ** 2)))
                if error < best.error - 1e-9:
                    gain = float(found.sum())
                    share = float(found[1] / gain) if len(found) > 1 else 0.0
                    best = StepResponse(
                        gain=gain, lag_s=float(lag), delay_s=float(delay), trail=share, trail_lag_s=float(trail_lag),
                        error=error,
                    )  # fmt: skip
    if not best.gain > LEAST_GAIN:
        raise RunError(f"the vehicle did not follow its set-points: it reached {best.gain:.0%} of them")
    return best

"""Orders and reports of the stream as blocks of numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from coral.contact.franka.stream import Orders, Phase, StopCause
from coral.contact.scene.observation import Array, BodyState, HandTarget

ORDERS_SIZE = 17
_HEAD = 57
_PER_OBJECT = 14


@dataclass(frozen=True)
class StreamReport:
    """The state of the stream after a tick; poses in the arm's base frame, objects in the world frame."""

    tick: int
    phase: Phase
    cause: StopCause
    time_s: float
    """The arm's clock."""
    tool: BodyState
    opening_m: float
    wrench: Array
    """Shape=(6,), without its bias."""
    joints: Array
    """Shape=(7,) rad."""
    speeds: Array
    """Shape=(7,) rad/s."""
    bias: Array
    """Shape=(6,), what is subtracted from the arm's wrench."""
    noise: Array
    """Shape=(6,), standard deviations of the wrench while its bias was measured."""
    late_p99_ms: float
    """99 % of the ticks that followed targets were late by less."""
    late_max_ms: float
    stop_latency_s: float
    """From the cause to the stop command."""
    stopped_at_s: float
    """When the stop command was given, on the machine's monotonic clock; 0 before."""
    still_after_s: float
    """From the stop command to the first state at rest, by the arm's clock; 0 before."""
    peak_force_n: float
    """Largest measured contact force while following targets."""
    malformed: int
    """Datagrams that were no poses."""
    objects: Mapping[str, BodyState]
    """Newest pose of each object that was seen."""
    ages_s: Mapping[str, float]
    """Ages of the poses; infinity for an object that was not seen."""


def encode_orders(orders: Orders) -> Array:
    """Return orders as numbers, Shape=(ORDERS_SIZE,)."""
    values = np.zeros(ORDERS_SIZE)
    values[:5] = orders.beat, orders.start, orders.stop, orders.quit, orders.target is not None
    if orders.target is not None:
        target = orders.target
        values[5:] = [*target.position, *target.quaternion, target.opening_m, target.stiffness, *target.force]
    return values


def decode_orders(values: Array) -> Orders:
    """Return the orders of `encode_orders`."""
    target = None
    if values[4]:
        target = HandTarget(values[5:8], values[8:12], float(values[12]), float(values[13]), values[14:17])
    return Orders(int(values[0]), bool(values[1]), StopCause(int(values[2])), bool(values[3]), target)


def report_size(objects: int) -> int:
    """Return the count of numbers in a report."""
    return _HEAD + _PER_OBJECT * objects


def encode_report(report: StreamReport, names: Sequence[str]) -> Array:
    """Return a report as numbers, Shape=(report_size(len(names)),)."""
    head = [
        report.tick, report.phase, report.cause, report.time_s, *_body(report.tool), report.opening_m, *report.wrench,
        *report.joints, *report.speeds, *report.bias, *report.noise, report.late_p99_ms, report.late_max_ms,
        report.stop_latency_s, report.stopped_at_s, report.still_after_s, report.peak_force_n, report.malformed,
    ]  # fmt: skip
    for name in names:
        pose = report.objects.get(name)
        head += [report.ages_s[name], *(np.zeros(13) if pose is None else _body(pose))]
    return np.array(head, float)


def decode_report(values: Array, names: Sequence[str]) -> StreamReport:
    """Return the report of `encode_report`."""
    cut = np.split(values[:_HEAD], np.cumsum([4, 13, 1, 6, 7, 7, 6, 6]))
    first, tool, opening, wrench, joints, speeds, bias, noise, rest = cut
    objects, ages = {}, {}
    for k, name in enumerate(names):
        one = values[_HEAD + k * _PER_OBJECT :][:_PER_OBJECT]
        ages[name] = float(one[0])
        if np.isfinite(one[0]):
            objects[name] = _from_body(one[1:])
    return StreamReport(
        tick=int(first[0]),
        phase=Phase(int(first[1])),
        cause=StopCause(int(first[2])),
        time_s=float(first[3]),
        tool=_from_body(tool),
        opening_m=float(opening[0]),
        wrench=wrench,
        joints=joints,
        speeds=speeds,
        bias=bias,
        noise=noise,
        late_p99_ms=float(rest[0]),
        late_max_ms=float(rest[1]),
        stop_latency_s=float(rest[2]),
        stopped_at_s=float(rest[3]),
        still_after_s=float(rest[4]),
        peak_force_n=float(rest[5]),
        malformed=int(rest[6]),
        objects=objects,
        ages_s=ages,
    )


def _body(body: BodyState) -> Array:
    return np.concatenate([body.position, body.quaternion, body.velocity, body.angular_velocity])


def _from_body(values: Array) -> BodyState:
    return BodyState(values[:3], values[3:7], values[7:10], values[10:13])

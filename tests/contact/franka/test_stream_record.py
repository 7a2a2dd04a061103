"""Orders and reports survive the way between the processes."""

import numpy as np
import pytest
from arms import DOWN

from coral.contact.franka.stream import Orders, Phase, StopCause
from coral.contact.franka.stream_record import (
    ORDERS_SIZE,
    StreamReport,
    decode_orders,
    decode_report,
    encode_orders,
    encode_report,
    report_size,
)
from coral.contact.scene.observation import BodyState, HandTarget


def numbers(n, start):
    return np.arange(n) + float(start)


def test_orders_come_back():
    target = HandTarget(numbers(3, 1), DOWN, 0.05, 600.0, numbers(3, 7))
    values = encode_orders(Orders(3, True, StopCause.PAGE, True, target))
    assert values.shape == (ORDERS_SIZE,)
    found = decode_orders(values)
    assert (found.beat, found.start, found.stop, found.quit) == (3, True, StopCause.PAGE, True)
    assert found.target.position == pytest.approx(target.position)
    assert found.target.force == pytest.approx(target.force)
    assert (found.target.opening_m, found.target.stiffness) == (0.05, 600.0)
    assert decode_orders(encode_orders(Orders())).target is None


def test_a_report_comes_back():
    body = BodyState(numbers(3, 1), numbers(4, 4), numbers(3, 8), numbers(3, 11))
    report = StreamReport(
        5, Phase.FOLLOWING, StopCause.NONE, 1.5, body, 0.04, numbers(6, 20), numbers(7, 30), numbers(7, 40),
        numbers(6, 50), numbers(6, 60), 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 7, {"lid": body}, {"box": np.inf, "lid": 0.25},
    )  # fmt: skip
    names = ("box", "lid")
    values = encode_report(report, names)
    assert values.shape == (report_size(2),)
    found = decode_report(values, names)
    for name in ("tick", "phase", "cause", "time_s", "opening_m", "late_p99_ms", "late_max_ms", "stop_latency_s",
                 "stopped_at_s", "still_after_s", "peak_force_n", "malformed", "ages_s"):  # fmt: skip
        assert getattr(found, name) == getattr(report, name), name
    for name in ("wrench", "joints", "speeds", "bias", "noise"):
        assert getattr(found, name) == pytest.approx(getattr(report, name)), name
    assert list(found.objects) == ["lid"]
    assert found.objects["lid"].angular_velocity == pytest.approx(body.angular_velocity)

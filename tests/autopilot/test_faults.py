"""Faults on command: what each does, when it ends, and what is no fault."""

import pytest

from autopilot.autopilot import AutopilotCfg, SimulatedAutopilot
from autopilot.body import Body, OpenWater
from autopilot.faults import FaultPlan, LineCondition, parse_fault
from coral.errors import InputError


def after(text, seconds):
    autopilot = SimulatedAutopilot(Body(OpenWater()), AutopilotCfg(position_after_s=0.0))
    line, plan, happened = LineCondition(), FaultPlan([parse_fault(text)]), []
    for _ in range(round(seconds / 0.05)):
        autopilot.step(0.05)
        happened += [(round(autopilot.time_s, 2), name) for name in plan.apply(autopilot, line)]
    return autopilot, line, happened


def test_a_fault_begins_and_ends_at_its_time():
    autopilot, _, happened = after("1:low-battery:2", 2.0)
    assert autopilot.parameters["SIM_BATT_VOLTAGE"] == 10.5
    autopilot, _, happened = after("1:low-battery:2", 4.0)
    assert autopilot.parameters["SIM_BATT_VOLTAGE"] == 12.6
    assert happened == [(1.0, "low-battery"), (3.0, "low-battery ends")]


@pytest.mark.parametrize(
    ("text", "seen"),
    [
        ("1:refuse-arming", lambda a, line: a.parameters["BATT_ARM_VOLT"] == 99.0),
        ("1:position-lost", lambda a, line: a.parameters["SIM_GPS1_ENABLE"] == 0.0),
        ("1:leak:30", lambda a, line: a.failsafes.leaking),
        ("1:reboot", lambda a, line: a.clock_s < 1.5),
        ("1:clock-jump:50", lambda a, line: a.clock_s > 50.0),
        ("1:pilot", lambda a, line: a.mode == "MANUAL"),
        ("1:link-loss", lambda a, line: line.silent),
        ("1:link-loss:1", lambda a, line: not line.silent),
        ("1:packet-loss", lambda a, line: line.loss == 0.5),
    ],
)
def test_every_fault_does_what_it_says(text, seen):
    autopilot, line, happened = after(text, 4.0)
    assert happened
    assert seen(autopilot, line)


@pytest.mark.parametrize("text", ["", "leak", "10:leek", "x:leak", "nan:leak", "-1:leak", "1:leak:inf", "1e9:leak"])
def test_everything_else_is_one_line(text):
    with pytest.raises(InputError, match="--fault"):
        parse_fault(text)

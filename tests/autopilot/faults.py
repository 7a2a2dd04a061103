"""Faults on command: what goes wrong with a simulated autopilot, and when."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from autopilot.autopilot import SimulatedAutopilot
from coral.errors import InputError, nearest

LONGEST_S = 1e6


@dataclass(frozen=True, kw_only=True)
class LinkFault:
    """One fault of an autopilot or of the line to it."""

    at_s: float
    """Autopilot's time since the start."""
    name: str
    seconds: float = 0.0
    """How long it lasts, or by how much the clock jumps; 0: to the end."""


class LineCondition:
    """The state of a line that faults change: silent drops everything, loss drops a share of the packets."""

    silent: bool = False
    loss: float = 0.0


def _parameter(name: str, bad: float) -> tuple[Callable[..., None], Callable[..., None]]:
    good: list[float] = []

    def begin(autopilot: SimulatedAutopilot, line: Any, seconds: float) -> None:
        good.append(autopilot.parameters[name])
        autopilot.parameters.write(name, bad)

    def end(autopilot: SimulatedAutopilot, line: Any) -> None:
        autopilot.parameters.write(name, good.pop())

    return begin, end


def _lines(field: str, bad: Any, good: Any) -> tuple[Callable[..., None], Callable[..., None]]:
    return (lambda autopilot, line, seconds: setattr(line, field, bad)), (
        lambda autopilot, line: setattr(line, field, good)
    )


def _nothing(autopilot: SimulatedAutopilot, line: Any) -> None:
    return


def _faults() -> dict[str, tuple[str, Callable[..., None], Callable[..., None]]]:
    """Return each fault's meaning, its beginning and its end."""
    return {
        "refuse-arming": ("the battery is too low to arm", *_parameter("BATT_ARM_VOLT", 99.0)),
        "low-battery": ("the battery falls to 10.5 V", *_parameter("SIM_BATT_VOLTAGE", 10.5)),
        "position-lost": ("the position sensor is silent", *_parameter("SIM_GPS1_ENABLE", 0.0)),
        "leak": ("water in the hull", lambda autopilot, line, seconds: autopilot.leak(seconds), _nothing),
        "reboot": ("the autopilot restarts", lambda autopilot, line, seconds: autopilot.reboot(), _nothing),
        "clock-jump": (
            "its clock jumps by SECONDS",
            lambda autopilot, line, seconds: autopilot.jump_clock(seconds),
            _nothing,
        ),
        "pilot": ("a pilot chooses MANUAL", lambda autopilot, line, seconds: autopilot.choose("MANUAL"), _nothing),
        "link-loss": ("nothing goes through the line", *_lines("silent", True, False)),
        "packet-loss": ("half of the packets are lost", *_lines("loss", 0.5, 0.0)),
    }


FAULTS = {name: meaning for name, (meaning, _, _) in _faults().items()}


def parse_fault(text: str) -> LinkFault:
    """Read `SECONDS:NAME` or `SECONDS:NAME:DURATION`, such as 60:link-loss:5.

    Raises:
        InputError: It is neither, or there is no such fault.
    """
    expected = f"SECONDS:NAME or SECONDS:NAME:DURATION, NAME one of {', '.join(FAULTS)}"
    at, _, rest = text.partition(":")
    name, _, duration = rest.partition(":")
    if name not in FAULTS:
        raise InputError("--fault", "", repr(text), f"{expected}{nearest(name, FAULTS)}")
    try:
        fault = LinkFault(at_s=float(at), name=name, seconds=float(duration or 0.0))
    except ValueError:
        raise InputError("--fault", "", repr(text), expected) from None
    if not (0.0 <= fault.at_s <= LONGEST_S and 0.0 <= fault.seconds <= LONGEST_S):
        raise InputError("--fault", "", repr(text), f"{expected}; times from 0 to {LONGEST_S:g} s")
    return fault


class FaultPlan:
    """Lets faults begin and end when their time has come."""

    def __init__(self, faults: Iterable[LinkFault] = ()) -> None:
        table = _faults()
        self._due: list[tuple[float, str, Callable[..., None]]] = []
        for fault in faults:
            _, begin, end = table[fault.name]
            self._due.append((fault.at_s, fault.name, self._begins(begin, fault.seconds)))
            if fault.seconds > 0.0 and end is not _nothing:
                self._due.append((fault.at_s + fault.seconds, f"{fault.name} ends", end))
        self._due.sort(key=lambda due: due[0])

    @staticmethod
    def _begins(begin: Callable[..., None], seconds: float) -> Callable[..., None]:
        return lambda autopilot, line: begin(autopilot, line, seconds)

    def apply(self, autopilot: SimulatedAutopilot, line: Any) -> list[str]:
        """Do what is due now. Return the names of what began or ended."""
        done = []
        while self._due and self._due[0][0] <= autopilot.time_s + 1e-9:
            _, name, act = self._due.pop(0)
            act(autopilot, line)
            done.append(name)
        return done

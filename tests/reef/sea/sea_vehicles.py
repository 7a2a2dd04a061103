"""Vehicles that tests drive: the simulated autopilot in steps, ArduSub in real time."""

import time

from autopilot.autopilot import AutopilotCfg, SimulatedAutopilot
from autopilot.body import Body, OpenWater
from autopilot.line import AutopilotLine
from coral.reef.sea.mavlink_link import MavlinkLink
from coral.reef.sea.transport import parse_address


class SimulatedVehicle:
    """A link without threads, whose time is the autopilot's: the same calls give the same numbers."""

    name = "simulated"

    def __init__(self, **autopilot):
        self.autopilot = SimulatedAutopilot(Body(OpenWater()), AutopilotCfg(position_after_s=1.0, **autopilot))
        self.line = AutopilotLine(self.autopilot)
        self.link = MavlinkLink(self.line, self.line.clock, threaded=False)

    def run(self, seconds, command=None):
        """Let time pass; repeat a command ten times a second."""
        until = self.line.clock() + seconds
        due = self.line.clock()
        while self.line.clock() < until - 1e-9:
            if command is not None and self.line.clock() >= due - 1e-9:
                self.link.command(*command)
                due += 0.1
            self.link.poll()
        return self.link.report()

    def now(self):
        return self.line.clock()

    def set_parameter(self, name, value):
        set_parameter(self.link, name, value)
        self.run(0.5)

    def close(self):
        self.link.close()


class ArduSub:
    """The same over TCP, in real time."""

    name = "ardusub"

    def __init__(self, port):
        self.link = MavlinkLink(parse_address(f"mavlink:tcp:127.0.0.1:{port}"))

    def run(self, seconds, command=None):
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            if command is not None:
                self.link.command(*command)
            time.sleep(0.1)
        return self.link.report()

    def now(self):
        return time.monotonic()

    def set_parameter(self, name, value):
        set_parameter(self.link, name, value)
        self.run(1.0)

    def close(self):
        self.link.close()


def set_parameter(link, name, value):
    link._send(link._dialect.MAVLink_param_set_message(1, 1, name.encode(), float(value), 9))

"""Serves the simulated autopilot in real time; Ctrl-C ends it: `python tests/autopilot s1 --fault 60:link-loss:5`."""

import argparse
import contextlib
import sys
import threading
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from autopilot.autopilot import AutopilotCfg, SimulatedAutopilot
from autopilot.body import Body, ReefWaters
from autopilot.faults import FAULTS, parse_fault
from autopilot.server import AutopilotServer


def main():
    """Serve until interrupted; the address goes to standard error."""
    parser = argparse.ArgumentParser(description=__doc__, epilog="Faults: " + ", ".join(FAULTS))
    parser.add_argument("world", nargs="?", default="", help="reef to swim in; open water by default")
    parser.add_argument("--tcp-port", type=int, default=5790, help="on 127.0.0.1; 0 chooses a free one")
    parser.add_argument("--ready-s", type=float, default=10.0, help="seconds until it has a position")
    parser.add_argument("--fault", action="append", default=[], help="SECONDS:NAME or SECONDS:NAME:DURATION")
    words = parser.parse_args()
    faults = [parse_fault(text) for text in words.fault]
    autopilot = SimulatedAutopilot(Body(ReefWaters(words.world)), AutopilotCfg(position_after_s=words.ready_s))
    server = AutopilotServer(autopilot, "tcp", port=words.tcp_port, faults=faults)
    print(f"a simulated BlueROV2 listens at {server.address}; Ctrl-C ends it", file=sys.stderr, flush=True)
    with contextlib.suppress(KeyboardInterrupt):
        threading.Event().wait()
    server.close()


if __name__ == "__main__":
    main()

"""`coral reef autopilot`: a simulated BlueROV2 that speaks MAVLink, for rehearsals without hardware."""

from __future__ import annotations

import sys
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from coral.config import read_yaml
from coral.errors import InputError
from coral.flags import Argument


@dataclass(frozen=True, kw_only=True)
class ReefAutopilot:
    """Serve a simulated BlueROV2 that speaks MAVLink as ArduSub does, in real time; Ctrl-C ends it.

    The rehearsal of `coral reef sail --vehicle mavlink:...`. It also appears in QGroundControl.
    """

    world: Annotated[str, Argument(metavar="[WORLD]")] = ""
    """Reef to swim in (a name or a file), with its obstacles; open water by default."""
    listen: str = "udp:127.0.0.1:14560"
    """udp:HOST:PORT or tcp:HOST:PORT; port 0 chooses a free one. Vehicles do not ask who speaks to them, nor does this
    one: leave it on 127.0.0.1 unless the network is yours."""
    ready_s: float = 10.0
    """Seconds until the autopilot has a position; ArduSub takes up to 60."""
    fault: tuple[str, ...] = ()
    """What goes wrong and when: SECONDS:NAME or SECONDS:NAME:DURATION. Names: refuse-arming, low-battery,
    position-lost, leak, reboot, clock-jump, pilot, link-loss, packet-loss."""
    parameters: Path | None = None
    """YAML file with parameters, such as FS_LEAK_ENABLE: 2."""
    time_limit_s: float = 0.0
    """End after so many seconds; 0 goes on."""
    json: bool = False
    """Print one JSON object at the end; the address goes to standard error."""

    def __call__(self) -> Mapping[str, Any]:
        """Serve until interrupted."""
        from coral.reef.rehearsal.autopilot import AutopilotCfg, SimulatedAutopilot
        from coral.reef.rehearsal.autopilot_faults import parse_fault
        from coral.reef.rehearsal.autopilot_server import AutopilotServer
        from coral.reef.rehearsal.body import Body, ReefWaters

        medium, host, port = _listen(self.listen)
        faults = [parse_fault(text) for text in self.fault]
        waters = ReefWaters(self.world)
        autopilot = SimulatedAutopilot(
            Body(waters), AutopilotCfg(position_after_s=self.ready_s), _parameters(self.parameters)
        )
        server = AutopilotServer(autopilot, medium, host, port, faults)
        print(f"a simulated BlueROV2 listens at {server.address}; Ctrl-C ends it", file=sys.stderr, flush=True)
        try:
            threading.Event().wait(self.time_limit_s or None)
        except KeyboardInterrupt:
            pass
        finally:
            server.close()
        pose = autopilot.body.pose
        return {
            "address": server.address,
            "time_s": round(autopilot.time_s, 2),
            "distance_m": round(waters.distance_m, 3),
            "collisions": waters.collisions,
            "pose": [round(value, 3) for value in pose],
            "mode": autopilot.mode,
            "armed": autopilot.armed,
            "faults": [{"time_s": round(at, 2), "name": name} for at, name in server.happened],
        }

    def describe(self, result: Mapping[str, Any]) -> str:
        """Report where it swam."""
        told = "".join(f"\n{fault['time_s']:8.1f} s  {fault['name']}" for fault in result["faults"])
        return (
            f"{result['distance_m']:.1f} m in {result['time_s']:.1f} s, {result['collisions']} collisions, "
            f"ended in {result['mode']}{' armed' if result['armed'] else ''}{told}"
        )


def _listen(text: str) -> tuple[str, str, int]:
    medium, _, rest = text.partition(":")
    host, _, port = rest.rpartition(":")
    if medium not in ("udp", "tcp") or not host or not (port.isascii() and port.isdigit() and len(port) < 6):
        raise InputError("--listen", "", repr(text), "udp:HOST:PORT or tcp:HOST:PORT")
    return medium, host, int(port)


def _parameters(path: Path | None) -> Any:
    from coral.errors import nearest
    from coral.reef.rehearsal.autopilot_parameters import ParameterStore

    store = ParameterStore()
    for name, value in (read_yaml(path) if path is not None else {}).items():
        number = value if isinstance(value, int | float) and not isinstance(value, bool) else float("nan")
        if not store.write(name, number):
            known = f"a number for one of {', '.join(store.names)}{nearest(str(name), store.names)}"
            raise InputError(str(path), str(name), repr(value), known)
    return store

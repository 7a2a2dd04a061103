"""The configuration of a mission means the same in simulated time and at sea: the same fields are read."""

import dataclasses
import sys
from collections import defaultdict
from contextlib import ExitStack

import pytest
from voyage import WORLD, Voyage

from coral.advisor.rules import RuleAdvisor
from coral.commands.reef_sail import ReefSail
from coral.commands.sail_parts import open_parts, read_area
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.map.localization import LocalizationCfg
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.resolution import with_sonar
from coral.reef.sea.safety import SafetyCfg
from reef.failing_sensors import fail

NOT_AT_SEA = {
    ("SimulatorCfg", "water_depth_m"): "the vehicle tells its depth; a rehearsal has that of --depth",
    ("SimulatorCfg", "stills"): "a camera at sea has its own pictures",
}
"""Fields that only a mission in simulated time reads, and why."""
COPIERS = ("dataclasses", "copy", "coral.config", "pydantic.type_adapter", __name__)
"""Modules that read a configuration whole, to copy, check or record it. `__post_init__` only checks, too."""


@pytest.fixture
def reads(monkeypatch):
    """Notes every field of a mission's configuration that is read; returns them by the name of their class."""
    noted = defaultdict(set)

    def watch(kind):
        names = {field.name for field in dataclasses.fields(kind)}

        def read(self, name):
            caller = sys._getframe(1)
            copies = caller.f_globals.get("__name__") in COPIERS or caller.f_code.co_name == "__post_init__"
            if name in names and not copies:
                noted[kind.__name__].add(name)
            return object.__getattribute__(self, name)

        monkeypatch.setattr(kind, "__getattribute__", read)

    def walk(value, seen):
        if dataclasses.is_dataclass(value) and type(value) not in seen:
            seen.add(type(value))
            for field in dataclasses.fields(value):
                walk(getattr(value, field.name), seen)
        return seen

    for kind in walk(MissionCfg(), set()):
        watch(kind)
    return noted


def taken(reads):
    found = {(kind, name) for kind, names in reads.items() for name in names}
    reads.clear()
    return found


def test_what_a_run_reads_is_read_at_sea(reads, tmp_path):
    drift = LocalizationCfg(drift_xy=0.02)
    cfg = with_sonar(MissionCfg(time_limit_s=12.0, latency="fixed:1", localization=drift))
    mission = Mission(WORLD, cfg, RuleAdvisor(REEF_RULES), tmp_path / "run")
    fail(mission.robot.vehicle, "blind-camera", 9.0, 11.0)
    mission.run()
    in_run = taken(reads)
    voyage = Voyage(tmp_path / "sail", cfg=cfg, time_limit_s=12.0, sonar=True)
    fail(voyage.mission.robot.vehicle, "blind-camera", 9.0, 11.0)
    voyage.run()
    flags = ReefSail(area="s1", cfg=cfg, safety=SafetyCfg(reserve_s=0.0), sonar="simulated")
    area, world, depth = read_area(flags.area)
    with ExitStack() as opened:
        open_parts(flags, area, world, flags._config(), depth, opened)
    assert in_run - taken(reads) - set(NOT_AT_SEA) == set()

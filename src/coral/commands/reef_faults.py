"""`coral reef faults`: break the sensors, one after the other, and measure what the vehicle does."""

from __future__ import annotations

import dataclasses
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from coral.advisor.rules import RuleAdvisor
from coral.commands.config_flag import configured
from coral.config import checked
from coral.errors import InputError, nearest
from coral.flags import Argument
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.fault_outcome import outcome_of
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.mission.resolution import with_sonar
from coral.reef.simulation.faults import FAULTS, SensorFault
from coral.reef.world.generated import find_world
from coral.reef.world.world_names import shipped_worlds
from coral.runs import read_events, read_rows

AFTER_S = 3.0
"""Time after the fault in which the vehicle goes on."""
HEADER = "| fault | what it is | what the vehicle says | held after | stands after | driven | goes on after |"


@dataclass(frozen=True, kw_only=True)
class ReefFaults:
    """Run one short mission for each fault of the sensors, and print what the vehicle did about it."""

    world: Annotated[str, Argument(metavar="[WORLD]", names=shipped_worlds)] = "s1"
    """A reef or a world file."""
    only: str = ""
    """Names of some faults, separated by commas; all by default."""
    list: bool = False
    """Only list the faults."""
    at: float = 10.0
    """Beginning of each fault (s)."""
    duration: float = 5.0
    """Duration of each fault (s)."""
    seed: int = 0
    """Seed of all random numbers."""
    out: Path | None = None
    """Keep the run folders here, one for each fault; by default none is kept."""
    config: Path | None = None
    """YAML file with configuration values; flags override it."""
    json: bool = False
    """Print one JSON object."""
    cfg: MissionCfg = field(default_factory=MissionCfg)
    """The mission."""

    @classmethod
    def from_file(cls, words: Sequence[str]) -> ReefFaults | None:
        """Read the defaults of the flags from the file that `--config` names, before the flags themselves."""
        cfg = configured(words, MissionCfg())
        return None if cfg is None else cls(cfg=cfg)

    def __call__(self) -> Mapping[str, Any]:
        """Run the missions."""
        names = [name.strip() for name in self.only.split(",") if name.strip()] or [*FAULTS]
        for name in names:
            if name not in FAULTS:
                raise InputError("--only", "", name, f"some of {', '.join(FAULTS)}{nearest(name, FAULTS)}")
        if self.list:
            return {"faults": [{"fault": name, "means": FAULTS[name].means} for name in names]}
        for flag, value in (("--at", self.at), ("--duration", self.duration)):
            if not 0.0 < value < 1e6:
                raise InputError(flag, "", value, "a number of seconds above 0")
        with tempfile.TemporaryDirectory() as folder:
            found = [self._outcome(name, (self.out or Path(folder)) / name) for name in names]
        return {"world": self.world, "seed": self.seed, "faults": found}

    def _outcome(self, name: str, folder: Path) -> dict[str, Any]:
        """Run the mission with one fault, and measure."""
        fault = SensorFault(name, self.at, self.duration)
        cfg = dataclasses.replace(
            with_sonar(self.cfg) if FAULTS[name].needs_sonar else self.cfg,
            faults=(f"{name}@{self.at:g}:{self.duration:g}",),
            time_limit_s=self.at + self.duration + AFTER_S,
            stop_when_covered=False,
            robots=1,
            record=RecordCfg(pictures=False, frames=False, report=False),
        )
        advisor = RuleAdvisor(REEF_RULES)
        Mission(find_world(self.world), checked(cfg, "--cfg"), advisor, folder, seed=self.seed).run()
        rows = read_rows(folder / "trajectory.csv")
        outcome = outcome_of(fault, [*read_events(folder / "events.jsonl")], rows)
        return {**dataclasses.asdict(outcome), "means": FAULTS[name].means}

    def describe(self, result: Mapping[str, Any]) -> str:
        """Return a table that a Markdown page can hold."""
        if self.list:
            return "\n".join(f"{one['fault']:<18} {one['means']}" for one in result["faults"])
        lines = [HEADER, "|---|---|---|---|---|---|---|"]
        for one in result["faults"]:
            times = (one["held_after_s"], one["stopped_after_s"])
            held, stands = ("drives on" if t is None else f"{t:.1f} s" for t in times)
            back = "" if one["back_after_s"] is None else f"{one['back_after_s']:.1f} s"
            struck = f", {one['collisions']} collisions" if one["collisions"] else ""
            lines.append(
                f"| `{one['fault']}` | {one['means']} | {one['said'] or 'nothing'} | {held} | {stands} | "
                f"{one['driven_m']:.2f} m{struck} | {back} |"
            )
        return "\n".join(lines)

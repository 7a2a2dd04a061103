"""`coral export`: a reef run for other tools."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from coral.errors import InputError
from coral.reef.recordings.bag_export import write_bag
from coral.reef.recordings.rerun_export import write_rerun
from coral.reef.recordings.run_recording import read_run
from coral.words import many

SUFFIX = {"bag": "_bag", "mcap": ".mcap", "rerun": ".rrd"}


@dataclass(frozen=True, kw_only=True)
class Export:
    """Write what a reef run saw and did: pictures, odometry, transforms, maps and points, as of REP-103 and REP-105."""

    run: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="RUN")]
    """Run folder of a reef mission."""
    to: Literal["mcap", "bag", "rerun"] = "mcap"
    """mcap: one file, for Foxglove and others. bag: a ROS 2 bag, a folder. rerun: a recording for rerun."""
    out: Path | None = None
    """What is written; it must not exist. By default RUN/RUN.mcap, RUN/RUN_bag or RUN/RUN.rrd."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        """Write it."""
        recording = read_run(self.run).located()
        out = self.out or self.run / f"{self.run.resolve().name}{SUFFIX[self.to]}"
        if out.exists():
            raise InputError(str(out), "--out", "something there already", "a new path")
        counts = write_rerun(recording, out) if self.to == "rerun" else write_bag(
            recording, out, single_file=self.to == "mcap"
        )  # fmt: skip
        size = out.stat().st_size if out.is_file() else sum(p.stat().st_size for p in out.rglob("*") if p.is_file())
        return {"export": str(out), "messages": counts, "bytes": size}

    def describe(self, result: Mapping[str, Any]) -> str:
        """Describe what was written in a line."""
        total, topics = sum(result["messages"].values()), len(result["messages"])
        return f"{result['export']}: {many(total, 'message')} on {topics} topics, {result['bytes'] / 1e6:.1f} MB"

"""Shared parts of the bench commands of both applications: digests of conditions, flags, executors, tables as JSON."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from coral.campaign.episode import Executor
from coral.campaign.local import LocalExecutor
from coral.campaign.slurm import SlurmCfg
from coral.campaign.table import Table


def digest(content: Any) -> str:
    """Compute twelve hexadecimal digits that identify contents."""
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()[:12]


def make_executor(kind: str, jobs: int, address: str, slurm: SlurmCfg, folder: Path) -> Executor:
    """Make the executor.

    Args:
        kind: "local", processes of this machine; "ray" or "slurm", a cluster.
        jobs: Maximum number of simultaneous episodes; Ray uses every core.
        address: Address of the Ray cluster.
        slurm: Requirements of a job on Slurm.
        folder: Folder for the jobs' scripts and logs on Slurm.
    """
    if kind == "ray":
        from coral.campaign.cluster import RayExecutor

        return RayExecutor(address)
    if kind == "slurm":
        from coral.campaign.slurm import SlurmExecutor

        return SlurmExecutor(folder, jobs, slurm)
    return LocalExecutor(jobs)


def table_json(table: Table) -> dict[str, Any]:
    """Return a table as plain values, its rows by column name."""
    return {
        "name": table.name,
        "caption": table.caption,
        "rows": [dict(zip(_unique(table.header), row, strict=True)) for row in table.rows],
        "notes": list(table.notes),
    }


def _unique(header: Sequence[str]) -> list[str]:
    """Make column names unique: a `paper` column is named after its neighbour."""
    return [f"{header[k - 1]}, paper" if label == "paper" else label for k, label in enumerate(header)]

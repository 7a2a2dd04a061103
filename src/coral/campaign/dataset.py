"""The records of a campaign as one Parquet data set, with one row per episode."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from coral.campaign.sweep import setting_text
from coral.errors import InputError
from coral.file_writer import write_whole

Row = dict[str, Any]


def to_rows(records: Iterable[Mapping[str, Any]], about: Mapping[str, Any] | None = None) -> list[Row]:
    """Flatten each record to a row: the spec, the result, then its provenance.

    Lists stay lists; other nested values become JSON text. A failed episode has its message and no results.
    """
    rows = []
    for record in records:
        spec = dict(record["spec"])
        row: Row = {
            **spec,
            "overrides": json.dumps(spec["overrides"], sort_keys=True),
            "setting": setting_text(spec["overrides"]),
            "status": record["status"],
            "failure": record.get("message", ""),
        }
        row |= {
            name: json.dumps(value, sort_keys=True) if isinstance(value, dict) else value
            for name, value in record.get("result", {}).items()
            if name not in row
        }
        row |= {name: value for name, value in {**(about or {}), **record["about"]}.items() if name not in row}
        rows.append(row)
    return rows


def write_parquet(rows: Sequence[Row], path: Path) -> None:
    """Write the rows as one Parquet file, atomically; a column is null if a row lacks it."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = {name: _column([row.get(name) for row in rows]) for name in names}
    sink = pa.BufferOutputStream()
    pq.write_table(pa.table(columns), sink, compression="zstd")
    write_whole(path, sink.getvalue().to_pybytes())


def read_parquet(path: Path) -> list[Row]:
    """Read the rows of a Parquet file.

    Raises:
        InputError: There is no such file, or it cannot be read.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        rows: list[Row] = pq.read_table(path).to_pylist()
    except (OSError, pa.ArrowException) as error:
        raise InputError(str(path), "", str(error).splitlines()[0], "a Parquet file of a campaign") from None
    return rows


def _column(values: list[Any]) -> list[Any]:
    """Convert values to one type: integers mixed with floats become floats, any other mixture text."""
    kinds = {type(value) for value in values if value is not None}
    if len(kinds) <= 1:
        return values
    if kinds == {int, float}:
        return [None if value is None else float(value) for value in values]
    return [None if value is None else str(value) for value in values]

"""The records of a campaign as one Parquet data set, with one row per episode."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from coral.campaign.sweep import setting_text
from coral.file_writer import write_whole
from coral.interface.result import column_of

Row = dict[str, Any]


def write_dataset(records: Iterable[Mapping[str, Any]], about: Mapping[str, Any], path: Path) -> list[Row]:
    """Write each record as a row of one Parquet file, atomically: the spec, the result, then its provenance.

    Lists stay lists; other nested values become JSON text. A failed episode has its message and no results. Return the
    rows as they can be read again, without a value where they lack a column.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    rows = [_row(record, about) for record in records]
    names = dict.fromkeys(name for row in rows for name in row)
    table = pa.table({name: column_of([row.get(name) for row in rows]) for name in names})
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd")
    write_whole(path, sink.getvalue().to_pybytes())
    written: list[Row] = table.to_pylist()
    return written


def _row(record: Mapping[str, Any], about: Mapping[str, Any]) -> Row:
    spec, result = record["spec"], record.get("result", {})
    plain = {name: json.dumps(v, sort_keys=True) if isinstance(v, dict) else v for name, v in result.items()}
    own = {
        **spec,
        "overrides": json.dumps(spec["overrides"], sort_keys=True),
        "setting": setting_text(spec["overrides"]),
        "status": record["status"],
        "failure": record.get("message", ""),
    }
    merged = {**about, **record["about"], **plain, **own}
    return {name: merged[name] for name in (*own, *plain, *about, *record["about"])}

"""Experiences in a LanceDB table, in a folder or in an object store shared by several machines.

Writers do not lock: each commits a new version, and retries on top of the latest one if another writer was faster
(optimistic concurrency). A row exists once its commit does.
"""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from datetime import timedelta
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pyarrow as pa

from coral.contact.memory.embedding import Vector
from coral.contact.memory.row import BUSY_S, Row
from coral.errors import InputError, first_line

T = TypeVar("T")
TABLE = "experience"
# With an explicit key, two writers that take the same number conflict; without it, both rows would be written.
KEY = {"lance-schema:unenforced-primary-key": "true"}
SCHEMA = pa.schema(
    [
        pa.field("id", pa.int64(), nullable=False, metadata=KEY),
        pa.field("created", pa.string()),
        pa.field("record", pa.string()),
        pa.field("embedder", pa.string()),
        # The length is not fixed: embedders differ, and there is no pure nearest-neighbour search.
        pa.field("vector", pa.list_(pa.float32())),
        pa.field("used", pa.int64()),
        pa.field("helped", pa.int64()),
    ]
)
ALL = 2**31 - 1


class LanceStore:
    """See `ExperienceStore`.

    Args:
        uri: A folder, or another URI of LanceDB (`s3://BUCKET/PATH`, ...; it reads keys from the environment).

    Raises:
        InputError: LanceDB is not installed.
    """

    def __init__(self, uri: str) -> None:
        self.name = f"lance:{uri}"
        self._folder = None if "://" in uri else Path(uri).expanduser()
        self._uri = uri if self._folder is None else str(self._folder)
        self._base: Any = None
        try:
            import lancedb  # type: ignore[import-not-found,unused-ignore]
        except ImportError:
            raise InputError(
                self.name, "", "no package lancedb", "the extra installed: pip install -e '.[lance]'"
            ) from None
        self._lance: Any = lancedb

    def exists(self) -> bool:
        """See `ExperienceStore.exists`."""
        return self._translate_errors(self._table) is not None

    def insert(self, created: str, record: str, embedder: str, vector: Vector) -> int:
        """See `ExperienceStore.insert`."""

        def written() -> int | None:
            table = self._connect().create_table(TABLE, schema=SCHEMA, exist_ok=True)
            ids = table.search().select(["id"]).limit(ALL).to_arrow()["id"].to_pylist()
            number = max(ids, default=0) + 1
            row = {
                "id": number,
                "created": created,
                "record": record,
                "embedder": embedder,
                "vector": vector.tolist(),
                "used": 0,
                "helped": 0,
            }
            merged = (
                table.merge_insert("id")
                .when_not_matched_insert_all()
                .execute(pa.Table.from_pylist([row], schema=SCHEMA))
            )
            return number if merged.num_inserted_rows == 1 else None  # None: another writer took the number

        return self._commit(written)

    def rows(self) -> list[Row]:
        """See `ExperienceStore.rows`."""
        table = self._translate_errors(self._table)
        if table is None:
            return []
        found = self._translate_errors(lambda: table.to_arrow().select(SCHEMA.names).sort_by("id").to_pylist())
        return [Row(**{**row, "vector": np.asarray(row["vector"], np.float32)}) for row in found]

    def delete(self, number: int) -> None:
        """See `ExperienceStore.delete`."""
        self._change(lambda table: table.delete(f"id = {int(number)}"))

    def count(self, number: int, helped: bool) -> None:
        """See `ExperienceStore.count`."""
        self._change(
            lambda table: table.update(
                where=f"id = {int(number)}", values_sql={"used": "used + 1", "helped": f"helped + {int(helped)}"}
            )
        )

    def _change(self, act: Callable[[Any], object]) -> None:
        def changed() -> bool:
            table = self._table()
            if table is not None:
                act(table)
            return True

        self._commit(changed)

    def _connect(self) -> Any:
        """Return the database; its tables are always looked up afresh."""
        if self._base is None:
            self._base = self._lance.connect(self._uri, read_consistency_interval=timedelta(0))
        return self._base

    def _table(self) -> Any:
        """Return the current table, or None without creating one."""
        if self._folder is not None and not self._folder.exists():
            return None
        if self._folder is not None and not self._folder.is_dir():
            raise NotADirectoryError("a file")
        try:
            return self._connect().open_table(TABLE)
        except ValueError as error:
            if "not found" in str(error):
                return None
            raise

    def _commit(self, act: Callable[[], T | None]) -> T:
        """Retry a write until no other writer commits first.

        Raises:
            InputError: The write fails, or other writers were always faster.
        """
        until, wait_s = time.monotonic() + BUSY_S, 0.01
        while True:
            try:
                done = act()
                if done is not None:
                    return done
            except Exception as error:
                if not _is_conflict(error) or time.monotonic() > until:
                    raise self._refusal(error) from None
            if time.monotonic() > until:
                raise self._refusal("others that write all the time")
            # Random jitter keeps colliding writers apart; no result depends on it.
            time.sleep(wait_s * random.random())
            wait_s = min(2 * wait_s, 0.5)

    def _translate_errors(self, act: Callable[[], T]) -> T:
        try:
            return act()
        except Exception as error:  # an unreadable remote store may raise anything
            raise self._refusal(error) from None

    def _refusal(self, why: object) -> InputError:
        found = first_line(why) if isinstance(why, Exception) else str(why)
        return InputError(self.name, "", found[:300], "a LanceDB table of experiences that can be opened")


def _is_conflict(error: Exception) -> bool:
    """Check whether a commit failed because another came first; LanceDB has no exception of its own for that."""
    text = str(error).lower()
    return any(word in text for word in ("conflict", "concurrent", f"'{TABLE}' already exists"))

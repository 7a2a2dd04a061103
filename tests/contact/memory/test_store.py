import builtins
import sqlite3
import subprocess
import sys
from contextlib import closing

import numpy as np
import pytest

from coral.contact.memory.row import Row
from coral.contact.memory.store import store_of
from coral.errors import InputError

VECTOR = np.array([0.25, -1.5], np.float32)


def test_rows_come_back_as_they_were_written(place):
    store = store_of(place("s"))
    assert not store.exists()
    assert store.rows() == []
    assert not store.exists()
    assert store.insert("then", "{'a': \"ü\"}", "e", VECTOR) == 1
    assert store.insert("now", "b", "f", np.zeros(5, np.float32)) == 2
    assert store.exists()
    row, other = store_of(store.name).rows()
    assert row == Row(1, "then", "{'a': \"ü\"}", "e", VECTOR, used=0, helped=0)
    assert row.vector.tolist() == VECTOR.tolist()
    assert row.vector.dtype == np.float32
    assert len(other.vector) == 5


def test_uses_are_counted_and_rows_deleted(place):
    store = store_of(place("s"))
    for _ in range(3):
        store.insert("now", "a", "e", VECTOR)
    store.count(1, helped=True)
    store.count(1, helped=False)
    store.count(9, helped=True)
    store.delete(2)
    store.delete(9)
    assert [(row.id, row.used, row.helped) for row in store.rows()] == [(1, 2, 1), (3, 0, 0)]


COUNTER = """
import sys
from coral.contact.memory.store import store_of
store = store_of(sys.argv[1])
print("ready", flush=True)
sys.stdin.readline()
for k in range(5):
    store.count(1, helped=k < 2)
"""


def test_processes_that_count_at_once_count_everything(place):
    store = store_of(place("s"))
    store.insert("now", "a", "e", VECTOR)
    counters = [
        subprocess.Popen([sys.executable, "-c", COUNTER, store.name], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        for _ in range(3)
    ]
    assert [counter.stdout.readline() for counter in counters] == [b"ready\n"] * 3
    for counter in counters:
        counter.stdin.write(b"\n")
        counter.stdin.flush()
    assert [counter.wait() for counter in counters] == [0] * 3
    for counter in counters:
        counter.communicate()
    assert [(row.used, row.helped) for row in store.rows()] == [(15, 6)]


@pytest.mark.parametrize("what", ["insert", "rows"])
def test_what_is_no_memory_is_an_error_that_names_it(place, tmp_path, what):
    for file in ("taken", "taken.sqlite"):
        (tmp_path / file).write_text("no memory, but long enough to be looked at as one" * 20)
    store = store_of(place("taken"))
    with pytest.raises(InputError, match="taken"):
        store.insert("now", "a", "e", VECTOR) if what == "insert" else store.rows()


def test_what_cannot_be_made_is_an_error_that_names_it(place, tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="below"):
        store_of(place("file/below")).insert("now", "a", "e", VECTOR)


def test_without_the_package_one_line_says_how_to_get_it(tmp_path, monkeypatch):
    there = builtins.__import__

    def without(name, *rest):
        if name == "lancedb":
            raise ImportError(name)
        return there(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(InputError, match=r"pip install -e '\.\[lance\]'"):
        store_of(f"lance:{tmp_path}")


def test_a_folder_is_named():
    with pytest.raises(InputError, match="lance:FOLDER"):
        store_of("lance:")


def test_a_path_is_a_file_whatever_it_is_called(tmp_path):
    assert store_of(tmp_path / "lance:x").name == str(tmp_path / "lance:x")


def test_reading_what_is_somebody_elses_does_not_write_into_it(tmp_path):
    with closing(sqlite3.connect(tmp_path / "theirs.sqlite")) as base, base:
        base.execute("CREATE TABLE things (name TEXT)")
    before = (tmp_path / "theirs.sqlite").read_bytes()
    with pytest.raises(InputError, match="no such table"):
        store_of(tmp_path / "theirs.sqlite").rows()
    assert (tmp_path / "theirs.sqlite").read_bytes() == before


def test_a_file_that_another_process_has_only_begun_holds_nothing(tmp_path):
    (tmp_path / "new.sqlite").touch()
    assert store_of(tmp_path / "new.sqlite").rows() == []


ENDLESS = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x FROM n"
FOREIGN = {
    "a vector that is missing": "CREATE TABLE experience (id, created, record, embedder, vector, used, helped);"
    "INSERT INTO experience VALUES (1, 'now', '{}', 'e', NULL, 0, 0)",
    "a vector of text": "CREATE TABLE experience (id, created, record, embedder, vector, used, helped);"
    "INSERT INTO experience VALUES (1, 'now', '{}', 'e', 'abc', 0, 0)",
    "a count of text": "CREATE TABLE experience (id, created, record, embedder, vector, used, helped);"
    "INSERT INTO experience VALUES (1, 'now', '{}', 'e', x'00', 'often', 0)",
    "a record of numbers": "CREATE TABLE experience (id, created, record, embedder, vector, used, helped);"
    "INSERT INTO experience VALUES (1, 'now', 5, 'e', x'00', 0, 0)",
    "text that is no text": "CREATE TABLE experience (id, created, record, embedder, vector, used, helped);"
    "INSERT INTO experience VALUES (1, 'now', CAST(x'ff' AS TEXT), 'e', x'00', 0, 0)",
    "a view without end": f"CREATE VIEW experience (id, created, record, embedder, vector, used, helped) AS "
    f"SELECT x, 'now', '{{}}', 'e', x'00', 0, 0 FROM ({ENDLESS})",
}


@pytest.mark.parametrize("what", sorted(FOREIGN))
def test_a_file_with_foreign_content_is_one_line(what, tmp_path):
    with closing(sqlite3.connect(tmp_path / "theirs.sqlite")) as base:
        base.executescript(FOREIGN[what])
    with pytest.raises(InputError, match=r"theirs\.sqlite") as caught:
        store_of(tmp_path / "theirs.sqlite").rows()
    assert "\n" not in str(caught.value)


def test_endless_work_of_a_file_is_stopped(tmp_path, monkeypatch):
    monkeypatch.setattr("coral.contact.memory.store_sqlite.LONGEST_S", -1.0)
    store = store_of(tmp_path / "m.sqlite")
    store.insert("now", "{}", "e", np.zeros(2))
    with closing(sqlite3.connect(tmp_path / "m.sqlite")) as base:
        base.executescript(
            "CREATE TABLE sink (x);"
            f"CREATE TRIGGER t AFTER DELETE ON experience BEGIN INSERT INTO sink SELECT x FROM ({ENDLESS}); END"
        )
    with pytest.raises(InputError, match="interrupted"):
        store.delete(1)

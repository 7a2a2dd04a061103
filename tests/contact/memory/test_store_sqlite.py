"""Experiences in one SQLite file: nothing of somebody else's is written, and foreign content is one line."""

import sqlite3
from contextlib import closing

import pytest

from coral.contact.memory.store_sqlite import SqliteStore
from coral.errors import InputError


def test_the_number_of_a_deleted_row_is_not_given_again(tmp_path):
    store = SqliteStore(tmp_path / "m.sqlite")
    for number in (1, 2):
        assert store.insert("now", "{}") == number
    store.delete(2)
    assert store.insert("now", "{}") == 3


def test_reading_what_is_somebody_elses_does_not_write_into_it(tmp_path):
    with closing(sqlite3.connect(tmp_path / "theirs.sqlite")) as base, base:
        base.execute("CREATE TABLE things (name TEXT)")
    before = (tmp_path / "theirs.sqlite").read_bytes()
    with pytest.raises(InputError, match="no such table"):
        SqliteStore(tmp_path / "theirs.sqlite").rows()
    assert (tmp_path / "theirs.sqlite").read_bytes() == before


def test_a_file_that_another_process_has_only_begun_holds_nothing(tmp_path):
    (tmp_path / "new.sqlite").touch()
    assert SqliteStore(tmp_path / "new.sqlite").rows() == []


ENDLESS = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x FROM n"
FOREIGN = {
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
        SqliteStore(tmp_path / "theirs.sqlite").rows()
    assert "\n" not in str(caught.value)


def test_endless_work_of_a_file_is_stopped(tmp_path, monkeypatch):
    monkeypatch.setattr("coral.contact.memory.store_sqlite.LONGEST_S", -1.0)
    store = SqliteStore(tmp_path / "m.sqlite")
    store.insert("now", "{}")
    with closing(sqlite3.connect(tmp_path / "m.sqlite")) as base:
        base.executescript(
            "CREATE TABLE sink (x);"
            f"CREATE TRIGGER t AFTER DELETE ON experience BEGIN INSERT INTO sink SELECT x FROM ({ENDLESS}); END"
        )
    with pytest.raises(InputError, match="interrupted"):
        store.delete(1)

"""LanceDB's commits: one that another writer was faster with is tried again; any other failure is one line.

What a store does with rows is tested on a real table in `test_store.py`; here a stand-in fails on request.
"""

import builtins
import sys
import types

import numpy as np
import pytest

from coral.contact.memory.store import store_of
from coral.errors import InputError

VECTOR = np.array([0.25, -1.5], np.float32)


class Table:
    """A table whose changes fail with the given errors, one after another, and then succeed."""

    def __init__(self):
        self.errors, self.deleted = [], []

    def delete(self, where):
        if self.errors:
            raise self.errors.pop(0)
        self.deleted.append(where)


@pytest.fixture
def table(monkeypatch):
    made = Table()
    base = types.SimpleNamespace(open_table=lambda name: made)
    monkeypatch.setitem(sys.modules, "lancedb", types.SimpleNamespace(connect=lambda uri, **_: base))
    monkeypatch.setattr("coral.contact.memory.store_lance.time.sleep", lambda seconds: None)
    return made


def test_a_commit_that_another_writer_was_faster_with_is_tried_again(table, tmp_path):
    table.errors = [RuntimeError("Commit conflict for version 3"), RuntimeError("Too many concurrent writers")]
    store_of(f"lance:{tmp_path}").delete(4)
    assert table.deleted == ["id = 4"]


def test_a_writer_that_is_never_the_first_gives_up(table, tmp_path, monkeypatch):
    monkeypatch.setattr("coral.contact.memory.store_lance.BUSY_S", -1.0)
    table.errors = [RuntimeError("Commit conflict")] * 2
    with pytest.raises(InputError, match="Commit conflict"):
        store_of(f"lance:{tmp_path}").delete(4)
    assert len(table.errors) == 1


def test_any_other_failure_is_not_tried_again(table, tmp_path):
    table.errors = [OSError("disk full\nand a trace"), OSError("never reached")]
    with pytest.raises(InputError, match="disk full") as caught:
        store_of(f"lance:{tmp_path}").delete(4)
    assert len(table.errors) == 1
    assert "\n" not in str(caught.value)


def test_a_folder_that_is_not_there_holds_nothing_and_is_not_made(table, tmp_path):
    store = store_of(f"lance:{tmp_path / 'none'}")
    assert not store.exists()
    assert store.rows() == []
    store.count(1, helped=True)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("error", "told"), [("Table 'experience' was not found", False), ("bad manifest", True)])
def test_a_missing_table_holds_nothing_but_a_broken_one_is_an_error(error, told, table, tmp_path, monkeypatch):
    def fail(name):
        raise ValueError(error)

    monkeypatch.setattr(sys.modules["lancedb"].connect(""), "open_table", fail)
    store = store_of(f"lance:{tmp_path}")
    if told:
        with pytest.raises(InputError, match="bad manifest"):
            store.rows()
    else:
        assert store.rows() == []


def test_a_file_in_the_place_of_the_folder_is_named(table, tmp_path):
    (tmp_path / "taken").write_text("x")
    with pytest.raises(InputError, match=r"lance:.*taken: found"):
        store_of(f"lance:{tmp_path / 'taken'}").rows()


def test_a_uri_is_handed_on_and_a_home_folder_is_found(monkeypatch, tmp_path):
    seen = []

    def connect(uri, **_):
        seen.append(uri)
        raise OSError("no such bucket")

    monkeypatch.setitem(sys.modules, "lancedb", types.SimpleNamespace(connect=connect))
    monkeypatch.setenv("HOME", str(tmp_path))
    for where in ("lance:s3://bucket/path", "lance:~"):
        with pytest.raises(InputError, match="no such bucket"):
            store_of(where).exists()
    assert seen == ["s3://bucket/path", str(tmp_path)]


def test_without_the_package_one_line_says_how_to_get_it(tmp_path, monkeypatch):
    there = builtins.__import__

    def without(name, *rest):
        if name == "lancedb":
            raise ImportError(name)
        return there(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(InputError, match=r"pip install -e '\.\[lance\]'"):
        store_of(f"lance:{tmp_path}")

import subprocess
import sys

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


def test_a_folder_is_named():
    with pytest.raises(InputError, match="lance:FOLDER"):
        store_of("lance:")


def test_a_path_is_a_file_whatever_it_is_called(tmp_path):
    assert store_of(tmp_path / "lance:x").name == str(tmp_path / "lance:x")

import os

import pytest

from coral import disk_cache
from coral.disk_cache import code_stamp, recall


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path


def unused():
    raise AssertionError("made again")


def test_a_value_is_made_once_for_each_key(cache):
    assert recall("a", "1", lambda: [1]) == [1]
    assert recall("a", "1", unused) == [1]
    assert recall("a", "2", lambda: [2]) == [2]
    assert recall("a", "2", unused) == [2]
    (kept,) = (path for path in cache.rglob("*") if path.is_file())
    assert kept.name == "a.json"


@pytest.mark.parametrize("broken", ["", "[]", '{"key": "1"}', '"\\ud800'])
def test_a_broken_file_is_made_again(cache, broken):
    recall("a", "1", lambda: 1)
    (file,) = (path for path in cache.rglob("*") if path.is_file())
    file.write_text(broken)
    assert recall("a", "1", lambda: 2) == 2


def test_a_home_that_cannot_be_written_is_no_error(monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", os.devnull)
    assert recall("a", "1", lambda: 3) == 3


def test_the_stamp_changes_with_the_files_of_the_package_and_with_what_is_installed(monkeypatch, tmp_path):
    before = code_stamp()
    assert code_stamp() == before
    monkeypatch.setattr(disk_cache, "_site_packages", lambda: {str(tmp_path)})
    installed = code_stamp()
    assert installed != before
    monkeypatch.setattr(disk_cache, "PACKAGE", tmp_path)
    (tmp_path / "a.py").write_text("1")
    one = code_stamp()
    (tmp_path / "a.py").write_text("12")
    assert len({installed, one, code_stamp()}) == 3

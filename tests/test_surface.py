import json
import os
import sys

import pytest

from coral import surface
from coral.surface import described, load

PLACE = "coral.commands.version:Version"


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path


def files(folder):
    return [path for path in folder.rglob("*") if path.is_file()]


def test_a_description_is_read_again_from_the_cache(cache, monkeypatch):
    first = described(PLACE)
    monkeypatch.setattr(surface, "load", lambda place: pytest.fail("imported"))
    assert described(PLACE) == first
    assert first.text == "Print the version."
    assert [file.name for file in files(cache)] == ["coral.commands.version.Version.json"]


@pytest.mark.parametrize("broken", ["", "[]", '{"code": 3}', '{"code": CODE, "described": {"text": ""}}'])
def test_a_broken_cache_is_made_again(cache, broken):
    first = described(PLACE)
    (file,) = files(cache)
    file.write_text(broken.replace("CODE", json.dumps(surface._code())))
    assert described(PLACE) == first


def test_changed_code_makes_it_again(cache, monkeypatch, tmp_path):
    described(PLACE)
    asked = []
    monkeypatch.setattr(surface, "load", lambda place: asked.append(place) or load(place))
    other = tmp_path / "installed"
    other.mkdir()
    monkeypatch.setattr(sys, "path", [*sys.path, str(other)])  # another package may bring names
    described(PLACE)
    assert asked == [PLACE]


def test_a_home_that_cannot_be_written_is_no_error(monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", os.devnull)
    assert described(PLACE).text == "Print the version."

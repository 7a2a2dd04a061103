import pytest

from coral import surface
from coral.surface import described

PLACE = "coral.commands.version:Version"


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


def test_a_description_is_read_again_without_importing_the_command(monkeypatch):
    first = described(PLACE)
    monkeypatch.setattr(surface, "load", lambda place: pytest.fail("imported"))
    assert described(PLACE) == first
    assert first.text == "Print the version."


def test_a_description_of_another_form_is_made_again(monkeypatch):
    monkeypatch.setattr(surface, "recall", lambda name, key, make: {"text": ""})
    assert described(PLACE).text == "Print the version."

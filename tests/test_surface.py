from importlib.metadata import EntryPoint

import pytest

from coral import plugins, surface
from coral.surface import CONFIGURATIONS, configuration_at, described, foreign_commands

PLACE = "coral.commands.doctor:Version"


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


def test_commands_of_other_packages_are_found_and_ours_stay_ours(monkeypatch):
    points = {name: EntryPoint(name, "theirs:Tune", "coral.commands") for name in ("reef.tune", "reef.run")}
    monkeypatch.setattr(plugins, "find_plugins", lambda group: points if group == "coral.commands" else {})
    assert foreign_commands({"reef run": ()}) == {"reef tune": ("theirs:Tune", "(of )")}


@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_every_configuration_has_keys_and_is_found_by_its_class(name):
    place, flag, _ = CONFIGURATIONS[name]
    assert flag.startswith("--")
    assert len(described(place).flags) > 5
    assert configuration_at(place) == name
    assert configuration_at("coral.nowhere:Nothing") is None

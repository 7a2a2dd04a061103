from importlib.metadata import EntryPoint

import pytest

from coral import plugins
from coral.errors import InputError
from coral.plugins import OURS, find_plugins, has_plugin, named_plugin, our_part

GROUP = "coral.triggers"


@pytest.fixture
def installed(monkeypatch):
    """Three entry points of one group, two of which do not load."""
    points = [
        EntryPoint("good", "math:hypot", GROUP),
        EntryPoint("gone", "no_such_module:x", GROUP),
        EntryPoint("bare", "math:no_such_name", GROUP),
    ]
    monkeypatch.setattr(plugins, "entry_points", lambda group: [point for point in points if point.group == group])


def test_an_entry_point_is_imported_by_its_name(installed):
    import math

    assert named_plugin(GROUP, "good", "--trigger") is math.hypot


def test_only_the_group_that_is_asked_for_is_searched(installed):
    assert find_plugins("coral.costs") == {}


def test_an_unknown_name_gives_one_line_with_the_nearest(installed):
    with pytest.raises(InputError, match=r"--trigger: found 'goood'.*group coral.triggers \(did you mean 'good'\?\)"):
        named_plugin(GROUP, "goood", "--trigger")


@pytest.mark.parametrize("name", ["gone", "bare"])
def test_one_that_does_not_load_is_named_with_its_value(installed, name):
    with pytest.raises(InputError, match=f"'{name}' of a package, which does not load .*no_such"):
        named_plugin(GROUP, name, "--trigger")


def test_a_part_of_ours_is_imported_by_its_place_and_its_name_cannot_be_taken(monkeypatch):
    from coral.contact.worlds.hand_world import HandWorld

    taken = [EntryPoint("hand", "math:hypot", "coral.worlds"), EntryPoint("mine", "math:hypot", "coral.worlds")]
    monkeypatch.setattr(plugins, "entry_points", lambda group: taken)
    assert named_plugin("coral.worlds", "hand", "--world") is HandWorld
    assert list(find_plugins("coral.worlds")) == ["panda", "hand", "mine"]
    assert has_plugin("coral.worlds", "mine")
    assert not has_plugin("coral.worlds", "other")


def test_a_part_of_a_missing_wing_is_one_line(monkeypatch):
    monkeypatch.setitem(plugins.OURS, "coral.tasks", {"libero": "coral.no_such_wing.task:load"})
    with pytest.raises(InputError, match=r"task: found 'libero', expected the wing coral.no_such_wing, which is not"):
        named_plugin("coral.tasks", "libero", "task")


@pytest.mark.parametrize(("group", "name"), [(group, name) for group, parts in OURS.items() for name in parts])
def test_every_part_of_ours_is_where_it_says(group, name):
    assert our_part(group, name, "test") is not None

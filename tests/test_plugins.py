from importlib.metadata import EntryPoint

import pytest

from coral import plugins
from coral.errors import InputError
from coral.plugins import find_plugins, named_plugin

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

"""Worlds by name: shipped ones, files, and those that the generator makes."""

import pytest

from coral import plugins
from coral.errors import InputError
from coral.reef.world.find_world import expand_names, find_world
from coral.reef.world.world import load_world, save_world


@pytest.mark.wing("coral.reef.generator")
def test_sets_of_reefs_have_names():
    assert expand_names(["s1", "gen:3-5", "gen:4"]) == ("s1", "gen:3", "gen:4", "gen:5")
    assert expand_names(["generated"]) == tuple(f"gen:{number}" for number in range(40))
    assert len(expand_names(["all", "generated"])) == 50
    assert expand_names(["words:net:1-2", "words:all:1"])[:3] == ("words:net:1", "words:net:2", "words:living:1")
    with pytest.raises(InputError, match="words:net:1-3"):
        expand_names(["words:net:3-1"])
    for name in ("gen:7-40", "gen:5-3"):
        with pytest.raises(InputError, match="within gen:0-39"):
            expand_names([name])


def test_shipped_worlds_need_no_generator(tmp_path):
    assert expand_names(["all", "s1", "mine.yaml"])[-1] == "mine.yaml"
    assert find_world("s1") == load_world("s1")
    save_world(load_world("s1"), tmp_path / "mine.yaml")
    assert find_world(tmp_path / "mine.yaml") == load_world("s1")


def test_worlds_are_not_made_without_the_generator(monkeypatch):
    monkeypatch.setitem(
        plugins.OURS, "generator", {"world": "coral.no_such_wing:make", "names": "coral.no_such_wing:n"}
    )
    for call in (lambda: find_world("gen:5"), lambda: expand_names(["generated"])):
        with pytest.raises(InputError, match=r"the wing coral\.no_such_wing, which is not installed"):
            call()


@pytest.mark.wing("coral.reef.generator")
def test_a_world_is_made_by_its_name(tmp_path, monkeypatch):
    assert find_world("gen:5").name == "gen-5"
    for name in ("gen:40", "gen:", "gen:x", "gen:-1"):
        with pytest.raises(InputError, match="gen:0 to gen:39"):
            find_world(name)
    monkeypatch.chdir(tmp_path)
    save_world(load_world("s1"), tmp_path / "gen:5")
    assert find_world("gen:5") == load_world("s1")  # a file of that name

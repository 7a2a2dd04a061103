import pytest
from pydantic import ValidationError

from coral.errors import InputError
from coral.reef.world.world import load_world, save_world
from coral.reef.world.world_model import ReefWorld


def test_solids_are_the_obstacles_and_then_what_they_hang_on():
    world = load_world("s1")
    assert world.solids[: len(world.obstacles)] == world.obstacles


def test_an_unknown_key_is_refused():
    with pytest.raises(ValidationError, match="colour"):
        ReefWorld.model_validate({**load_world("s1").model_dump(), "colour": "red"})


THINGS = [
    {"name": "clump", "kind": "living-clump", "x": 4.0, "y": 3.0},
    {"name": "grass", "kind": "sea-grass", "x": 5.0, "y": 4.0},
    {"name": "pile", "kind": "piling", "x": 6.0, "y": 2.0},
]


def test_a_thing_adds_its_solids_by_its_class_and_is_saved_with_them(tmp_path):
    world = ReefWorld.model_validate(
        {"name": "w", "size_m": [8.0, 6.0], "start": {"x": 1.0, "y": 3.0}, "clusters": [], "things": THINGS}
    )
    assert [(group.name, group.kind) for group in world.clusters] == [("clump", "living-clump")]
    assert [group.name for group in world.lying] == ["grass"]
    assert [post.thing for post in world.obstacles] == ["pile"]
    save_world(world, tmp_path / "w.yaml")
    assert load_world(tmp_path / "w.yaml") == world


def test_only_living_oysters_of_a_thing_are_true_ones(tmp_path):
    kinds = ("ghost-net", "dead-shell", "plot-young")
    things = [{"name": kind, "kind": kind, "x": 3.0 + 2 * k, "y": 3.0} for k, kind in enumerate(kinds)]
    content = {"name": "w", "size_m": [10.0, 6.0], "start": {"x": 1.0, "y": 3.0}, "clusters": [], "things": things}
    world = ReefWorld.model_validate(content)
    assert [(group.name, {one.look for one in group.oysters}) for group in world.clusters] == [("plot-young", {"spat"})]
    assert [group.name for group in world.alike] == list(kinds)
    assert {one.look for one in world.alike[-1].oysters} == {"pipe"}
    bare = ReefWorld.model_validate(content | {"things": things[:1]})
    save_world(bare, tmp_path / "w.yaml")
    assert load_world(tmp_path / "w.yaml") == bare
    assert bare.clusters == ()


def test_a_world_without_things_is_written_as_before():
    world = load_world("l1")
    assert not {"things", "alike", "lying", "mission"} & set(world.model_dump(mode="json"))
    assert not {"kind", "look", "shape"} & set(world.model_dump(mode="json")["clusters"][0]["oysters"][0])


def test_two_things_of_one_name_are_refused(tmp_path):
    file = tmp_path / "w.yaml"
    file.write_text(
        "name: w\nsize_m: [8, 6]\nstart: {x: 1, y: 3}\nthings:\n"
        "  - {name: c, kind: tyre, x: 3, y: 4}\n"
        "  - {name: a, kind: cable, x: 3, y: 3}\n  - {name: a, kind: cable, x: 5, y: 3}\n"
    )
    with pytest.raises(InputError, match=r"things\[2\]"):
        load_world(file)

"""World files: what loads, what is refused and in which words, what is written."""

import json
import math
import os

import pytest
import yaml

from coral.errors import InputError
from coral.reef.world.world import (
    Cluster,
    Oyster,
    ReefWorld,
    Start,
    load_world,
    read_mapping,
    save_world,
    shipped_worlds,
)
from coral.reef.world.world_names import WORLDS_DIR


def plain() -> dict:
    """A small valid world as the plain values of a file."""
    oyster = {"x": 7.0, "y": 5.0, "z": 0.05, "radii": [0.1, 0.08, 0.05]}
    return {
        "name": "pool",
        "size_m": [10.0, 10.0],
        "start": {"x": 2.0, "y": 5.0},
        "clusters": [
            {"name": "a", "oysters": [dict(oyster), dict(oyster, x=7.2)]},
            {"name": "b", "oysters": [dict(oyster, y=8.0)]},
        ],
        "obstacles": [{"shape": "box", "x": 4.0, "y": 2.0, "z": 0.6, "size": [0.3, 0.2, 0.6], "yaw": 0.3}],
    }


def changed(path: str, value: object) -> dict:
    """The small world with one value put somewhere, such as at `clusters.0.name`."""
    world = plain()
    *parents, last = [int(part) if part.isdigit() else part for part in path.split(".")]
    place = world
    for part in parents:
        place = place[part]
    place[last] = value
    return world


def refusal(tmp_path, content: dict) -> InputError:
    """The error of loading some values."""
    path = tmp_path / "w.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_world(path)
    assert caught.value.where == str(path)
    assert "\n" not in str(caught.value)
    return caught.value


def test_a_small_world_loads_with_defaults(tmp_path):
    path = tmp_path / "w.yaml"
    path.write_text(yaml.safe_dump(plain()))
    world = load_world(path)
    assert world.topology == "custom"
    assert world.clusters[0].oysters[1].x == 7.2
    assert world.current.x_m_s == 0.0


@pytest.mark.parametrize(
    ("path", "value", "field", "words"),
    [
        ("size_m", [-3.0, 10.0], "size_m[0]", "greater than 0"),
        ("size_m", "10x10", "size_m", "a list"),
        ("size_m", [10.0], "size_m", "2 entries"),
        ("start", None, "start", "a mapping with the keys x, y, theta"),
        ("start.x", math.nan, "start.x", "finite"),
        ("start.x", "left", "start.x", "number"),
        ("start.x", 11.0, "start.x", "0 to 10 m"),
        ("start.thetta", 1.0, "start.thetta", "did you mean 'theta'?"),
        (
            "clusters.0.oysters.1.radius",
            0.1,
            "clusters[0].oysters[1].radius",
            "z, radii, rpy, shape, look (did you mean 'radii'?)",
        ),
        ("clusters.1.oysters.0.radii", [-0.1, 0.1, 0.1], "clusters[1].oysters[0].radii[0]", "0.001"),
        ("clusters", [], "clusters", "at least 1"),
        ("obstacles.0.shape", "spher", "obstacles[0].shape", "'sphere'"),
        ("obstacles.0.shape", "cylinder", "obstacles[0]", "two equal radii"),
        ("format", "coral-reef/9", "format", "'coral-reef/1'"),
        ("seed", -1, "seed", "greater than or equal to 0"),
    ],
)
def test_a_wrong_value_is_named(tmp_path, path, value, field, words):
    error = refusal(tmp_path, changed(path, value))
    assert error.field == field
    assert words in error.expected


def test_a_missing_value_is_named(tmp_path):
    world = plain()
    del world["clusters"][0]["oysters"][1]["z"]
    error = refusal(tmp_path, world)
    assert (error.field, error.found) == ("clusters[0].oysters[1].z", "nothing")


def test_an_unknown_name_gets_the_nearest_shipped_one():
    with pytest.raises(InputError, match=r"found 'S9'.*did you mean 's"):
        load_world("S9")
    for name in ("x" * 5000, "a\0b", "a\0b.yaml"):
        with pytest.raises(InputError):
            load_world(name)


def test_what_is_saved_loads_as_it_was(tmp_path):
    world = ReefWorld(
        name="a: b, [c]",
        size_m=(10.0, 12.5),
        start=Start(x=1.0, y=1.0, theta=-0.25),
        spine=(((1.0, 1.0), (5.0, 5.0)),),
        clusters=(Cluster(name="10", oysters=(Oyster(x=5.0, y=5.0, z=0.0, radii=(0.1, 0.1, 0.05)),)),),
        seed=7,
    )
    path = tmp_path / "w.yaml"
    save_world(world, path, "made by hand")
    assert load_world(path) == world
    text = path.read_text()
    assert text.startswith("# made by hand\n")
    assert "      - {x: 5.0, y: 5.0, z: 0.0, radii: [0.1, 0.1, 0.05], rpy: [0.0, 0.0, 0.0]}\n" in text
    assert os.listdir(tmp_path) == ["w.yaml"]


def test_saving_rounds_to_the_millimetre(tmp_path):
    world = ReefWorld.model_validate(changed("start.x", 2.00049))
    save_world(world, tmp_path / "w.yaml")
    assert load_world(tmp_path / "w.yaml").start.x == 2.0


def test_saving_where_nothing_can_be_written_is_an_input_error(tmp_path):
    world = ReefWorld.model_validate(plain())
    with pytest.raises(InputError, match="a file that can be written"):
        save_world(world, tmp_path)


def test_schema_file_is_that_of_the_model():
    assert json.loads((WORLDS_DIR / "schema.json").read_text()) == ReefWorld.model_json_schema()


def test_ten_worlds_are_shipped():
    assert shipped_worlds() == ["l1", "l2", "s1", "s2", "k1", "k2", "e1", "e2", "o1", "o2"]


@pytest.mark.parametrize(
    ("content", "field", "words"),
    [
        ("name: [1,\nsize: }", "line 2", "did not find expected node content"),
        ("size_m: [8, 6\nname: a", "line 2", "line 2: a ',' or ']' is missing"),
        ("start: {x: 1\nname: a", "line 2", "line 2: a ',' or '}' is missing"),
        ("name: a: b", "line 1", "line 1: a ':' too many"),
        ("a:\n- {z: 1}\n- {x: 14,00, y: 2}", "line 3", "'00' after a comma has no value; numbers have a decimal point"),
        ("", "", "an empty file"),
        ("[1, 2]", "", "a list"),
        (b"\xff\xfe\x00\x80", "", "UTF-8"),
        ("name: !!python/object:os.system x", "line 1", "constructor"),
        ("clusters: &a [*a]", "line 1", "inside itself"),
        (
            "\n".join(["a0: &a0 [1, 1]", *(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 9))]),
            "line 7",
            "more than",
        ),
    ],
)
def test_a_file_that_is_no_world_is_refused(tmp_path, content, field, words):
    path = tmp_path / "w.yaml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InputError) as caught:
        read_mapping(path)
    assert (caught.value.where, caught.value.field) == (str(path), field)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    for path, found in ((tmp_path / "none.yaml", "no such file"), (tmp_path, "a folder")):
        with pytest.raises(InputError, match=found):
            read_mapping(path)

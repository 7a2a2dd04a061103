"""Worlds and configurations with an odd value at some place: read, or refused in one line."""

import copy

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from coral.config import read_config, to_mapping
from coral.errors import InputError
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.world.world import load_world, shipped_worlds

HUGE = int("9" * 400)
ODD = [
    "x",
    None,
    [1],
    {"a": 1},
    float("inf"),
    float("nan"),
    -1e300,
    1e-300,
    HUGE,
    True,
    [[]],
    {},
    0,
    -1,
    "x" * 5000,
    "\x1b",
]
CONFIG = to_mapping(MissionCfg())
WORLD = yaml.safe_load(
    "{name: pond, size_m: [9.0, 7.0], start: {x: 1.0, y: 3.0, theta: 0.0}, current: {}, seabed: {}, seed: 1, clusters: "
    "[{name: near, oysters: [{x: 5.0, y: 3.0, z: 0.05, radii: [0.12, 0.09, 0.06]}]}], obstacles: "
    "[{shape: cylinder, x: 3.0, y: 1.0, z: 0.7, size: [0.15, 0.15, 0.7], yaw: 0.0}], topology: S, "
    "spine: [[[1, 2], [2, 3]]]}"
)


def places(node, path=()):
    children = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    return [path, *(place for key, child in children for place in places(child, (*path, key)))]


def changed(content, path, value):
    """A copy with another value at a place."""
    if not path:
        return value
    content = copy.deepcopy(content)
    node = content
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = value
    return content


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    return tmp_path_factory.mktemp("foreign") / "file.yaml"


@settings(max_examples=80, deadline=None)
@given(st.sampled_from(places(CONFIG)), st.sampled_from(ODD))
def test_any_configuration_is_read_or_refused_in_one_line(file, path, value):
    config = changed(CONFIG, path, value)
    file.write_text(yaml.safe_dump({path[0]: config[path[0]]} if path else config))
    try:
        cfg = read_config(file, MissionCfg())
    except InputError as error:
        told = str(error)
    else:
        assert isinstance(cfg, MissionCfg)
        told = ""
    assert "\n" not in told
    assert len(told) < 1500


@settings(max_examples=80, deadline=None)
@given(st.sampled_from(places(WORLD)), st.sampled_from(ODD))
def test_any_world_is_read_or_refused_in_one_line(file, path, value):
    file.write_text(yaml.safe_dump(changed(WORLD, path, value)))
    try:
        told = load_world(file).name
    except InputError as error:
        told = str(error)
    assert "\n" not in told
    assert len(told) < 1500


def test_what_is_changed_is_valid_as_it_stands(file):
    file.write_text(yaml.safe_dump(CONFIG))
    assert read_config(file, MissionCfg()) == MissionCfg()
    file.write_text(yaml.safe_dump(WORLD))
    assert load_world(file).name == "pond"
    assert shipped_worlds()

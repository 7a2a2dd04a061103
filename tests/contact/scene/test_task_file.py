"""Task files: what loads, what is refused and in which words."""

import json
import math
from itertools import pairwise

import pytest
import yaml
from contact_bench import changed, plain, stl, written
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from coral.contact.scene.task_file import task_schema
from coral.contact.scene.task_names import HALVES, SUITES, TASKS_DIR, every_task, suite_tasks
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.errors import InputError


@pytest.mark.parametrize("name", every_task())
def test_shipped_tasks_load_and_can_be_drawn(name):
    task = load_task(name)
    assert task.name == name
    assert set(sample_trial(task, 3).objects) == {item.name for item in task.objects}


@pytest.mark.parametrize("suite", [suite for suite in SUITES if suite != "force"])
def test_a_suite_has_two_halves_that_share_no_task(suite):
    halves = [suite_tasks(suite, half) for half in HALVES]
    assert sorted([*halves[0], *halves[1]]) == list(suite_tasks(suite))
    assert len(halves[0]) == len(halves[1]) >= 4
    with pytest.raises(InputError, match="did you mean 'test'"):
        suite_tasks(suite, "tets")


def test_no_two_tasks_share_a_name():
    assert len(set(every_task())) == len(every_task())


def test_the_schema_file_is_current():
    assert json.loads((TASKS_DIR / "schema.json").read_text()) == task_schema(), (
        "run python -m coral.contact.scene.task_file"
    )


def test_a_required_key_that_is_misspelt_is_named(tmp_path):
    content = plain()
    content["objects"][0]["mas_kg"] = content["objects"][0].pop("mass_kg")
    with pytest.raises(InputError, match=r"objects\[0\]\.mas_kg: found an unknown key.*did you mean 'mass_kg'"):
        written(tmp_path, content)


def test_a_key_given_twice_is_refused(tmp_path):
    path = tmp_path / "task.yaml"
    path.write_text("format: coral-contact/1\nname: first\nname: second\n", encoding="utf-8")
    with pytest.raises(InputError, match="line 3: the key 'name' twice"):
        load_task(path)


def test_the_table_may_stand_anywhere(tmp_path):
    task = written(tmp_path, plain() | {"table": {"center": [0.3, 0.1], "size": [1, 1, 0.1]}})
    assert task.table.center == (0.3, 0.1)


CONDITION = "success.conditions.0"
BAD = [
    ("name", "Has Spaces", "name", "text like"),
    ("name", 3, "name", "string"),
    ("title", "", "title", "at least 1"),
    ("titel", "x", "titel", "did you mean 'title'?"),
    ("format", "coral-contact/2", "format", "coral-contact/1"),
    ("time_limit_s", 0, "time_limit_s", "greater than 0"),
    ("time_limit_s", True, "time_limit_s", "number"),
    ("time_limit_s", "10", "time_limit_s", "number"),
    ("time_limit_s", math.nan, "time_limit_s", "finite"),
    ("time_limit_s", math.inf, "time_limit_s", "finite"),
    ("time_limit_s", None, "time_limit_s", "a value"),
    ("objects", [], "objects", "at least 1"),
    ("objects", {}, "objects", "a list"),
    ("objects.0", 3, "objects[0]", "a mapping with the keys name, label"),
    ("objects.0.name", "Box", "objects[0].name", "text like"),
    ("objects.0.name", "table", "objects[0].name", "taken"),
    ("objects.0.name", "wall", "objects[0].name", "taken"),
    ("objects.0.name", "target", "objects[0].name", "taken"),
    *(("objects.0.name", name, "objects[0].name", "taken") for name in ("cmd", "step", "t", "event", "source", "self")),
    ("objects.0.mas_kg", 1, "objects[0].mas_kg", "did you mean 'mass_kg'?"),
    ("objects.0.mass_kg", [0.4, 0.1], "objects[0].mass_kg", "lower end first"),
    ("objects.0.mass_kg", "0.15-0.3", "objects[0].mass_kg", "expected a number, or a range [low, high]"),
    ("objects.0.mass_kg", 0, "objects[0].mass_kg[0]", "0.005"),
    ("objects.0.mass_kg", None, "objects[0].mass_kg", "a value"),
    ("objects.0.mass_kg", True, "objects[0].mass_kg", "a number, or a range"),
    ("objects.0.mass_kg", [True, 1], "objects[0].mass_kg[0]", "number"),
    ("objects.0.friction", [0.1, 0.2, 0.3], "objects[0].friction", "at most 2"),
    ("objects.0.friction", [0.1, math.nan], "objects[0].friction[1]", "finite"),
    ("objects.0.scale", [1, 1, [2, 1]], "objects[0].scale[2]", "lower end first"),
    ("objects.0.yaw_deg", [30, -30], "objects[0].yaw_deg", "lower end first"),
    ("objects.0.x", [0.3, 0.6], "objects[0].x", "on the table, from -0.4 to 0.4"),
    ("objects.0.color", [1, 2, 0], "objects[0].color[1]", "less than or equal to 1"),
    ("objects.0.symmetry", "round", "objects[0].symmetry", "'cylinder'"),
    ("objects.0.points", {"Top": [0, 0, 0]}, "objects[0].points.Top.[key]", "text like"),
    ("objects.0.points", {"init": [0, 0, 0]}, "objects[0].points", "init"),
    ("objects.0.parts.0.size", [0.1, 0.1], "objects[0].parts[0].size", "3 entries"),
    ("objects.0.parts.0.size", [0.1, 0.1, -0.1], "objects[0].parts[0].size[2]", "0.001"),
    ("objects.0.parts.0.shape", "cone", "objects[0].parts[0].shape", "'sphere'"),
    ("objects.0.parts.0", {"shape": "cylinder", "size": [0.1, 0.2, 0.1]}, "objects[0].parts[0]", "first two"),
    ("objects.0.parts.0", {"shape": "sphere", "size": [0.1, 0.1, 0.2]}, "objects[0].parts[0]", "three"),
    ("objects.0.parts.0", {"shape": "mesh", "size": [1, 1, 1]}, "objects[0].parts[0]", "a mesh with its file"),
    ("objects.0.parts.0.file", "a.stl", "objects[0].parts[0]", "another shape without one"),
    ("fixtures.0.position", "here", "fixtures[0].position", "a list"),
    ("fixtures.0.name", "hand", "fixtures[0].name", "taken"),
    ("places", {"box": [0, 0, 0]}, "places.box", "taken"),
    ("places", [1], "places", "dictionary"),
    ("places", {"goal": [0, 0, True]}, "places.goal[2]", "number"),
    ("numbers", {"time": 3}, "numbers.time", "taken"),
    ("numbers", {"box_pos": 3}, "numbers.box_pos", "taken"),
    ("numbers", {"n": "3"}, "numbers.n", "number"),
    ("success.hold_s", -1, "success.hold_s", "greater than or equal to 0"),
    ("success.conditions", [], "success.conditions", "at least 1"),
    (f"{CONDITION}.kind", "releasd", "success.conditions[0].kind", "did you mean 'released'?"),
    (f"{CONDITION}.kind", None, "success.conditions[0].kind", "a value"),
    (f"{CONDITION}.object", "bix", "success.conditions[0].object", "did you mean 'box'?"),
    (CONDITION, {"kind": "lifted", "object": "box"}, "success.conditions[0].height_m", "a value"),
    (CONDITION, {"kind": "lifted", "object": "box", "height": 1}, "success.conditions[0].height", "'height_m'?"),
    (CONDITION, {"kind": "released", "object": "box", "objet": 1}, "success.conditions[0].objet", "'object'?"),
    (
        CONDITION,
        {"kind": "at", "object": "box", "place": "gaol", "tolerance_m": 0.1},
        "success.conditions[0].place",
        "did you mean 'goal'?",
    ),
    (
        CONDITION,
        {"kind": "at", "object": "box", "place": "goal", "tolerance_m": 0.1, "point": "edge"},
        "success.conditions[0].point",
        "one of corner",
    ),
    (CONDITION, {"kind": "resting", "object": "box", "thing": "box"}, "success.conditions[0].thing", "table, wall"),
    (
        CONDITION,
        {"kind": "touched-while-turning", "object": "box", "thing": "wall", "between_deg": [75, 15]},
        "success.conditions[0].between_deg",
        "lower end first",
    ),
    (CONDITION, {"kind": "steady-force", "object": "box", "newtons": True}, "success.conditions[0].newtons", "number"),
]


@pytest.mark.parametrize(
    ("place", "value", "field", "expected"), BAD, ids=[f"{k}-{place}" for k, (place, *_) in enumerate(BAD)]
)
def test_refuses(tmp_path, place, value, field, expected):
    with pytest.raises(InputError) as caught:
        written(tmp_path, changed(place, value))
    assert caught.value.where == str(tmp_path / "task.yaml")
    assert caught.value.field == field, str(caught.value)
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


BOMB = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{new}: &{new} [{', '.join([f'*{old}'] * 9)}]\n" for old, new in pairwise("abcdefghijklm")
)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "nothing"),
        ("- 1", "a mapping"),
        ("a: [", "line"),
        (b"\xff\xfe\x00", "not UTF-8 text"),
        ("when: 2026-13-45", "when: found an unknown key"),
        ("a: " + "[" * 3000, ""),
        ("? [1, 2]\n: 3", "unhashable"),
        ("1: 2", "found nothing"),
        (BOMB, "values"),
        ("a: &a [*a]", "values"),
    ],
    ids=range(10),
)
def test_refuses_text(tmp_path, text, expected):
    with pytest.raises(InputError) as caught:
        written(tmp_path, text)
    assert expected in str(caught.value)
    assert len(str(caught.value)) < 1000 + len(str(tmp_path))


def test_refuses_unknown_names_and_folders(tmp_path):
    with pytest.raises(InputError, match="did you mean 'pick-box'"):
        load_task("pick-bax")
    for path in (tmp_path, tmp_path / "no.yaml"):
        with pytest.raises(InputError):
            load_task(path)


def test_meshes_lie_beside_the_task_file(tmp_path, monkeypatch):
    (tmp_path / "meshes").mkdir()
    stl(tmp_path / "meshes" / "part.STL", at=(5, 0, 0))
    part = {"shape": "mesh", "file": "meshes/part.STL", "size": [0.1, 0.1, 0.1]}
    monkeypatch.chdir("/")
    task = written(tmp_path, changed("objects.0.parts.0", part))
    assert task.objects[0].parts[0].file == str(tmp_path / "meshes" / "part.STL")
    # The file's own frame holds, however far from its middle it is.
    corners = sample_trial(task, 0).corners("box")
    assert corners.min(axis=0) == pytest.approx([0.5, 0, 0], abs=1e-6)
    assert corners.max(axis=0) == pytest.approx([0.6, 0.1, 0.1], abs=1e-6)


SCRAPS = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-3, 400)
    | st.floats()
    | st.text(max_size=5)
    | st.sampled_from(["box", "wall", "goal", "mesh", "at", "lifted", "table"]),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(["name", "kind", "object", "size", "parts", "file", "place", "conditions", "x"])
            | st.text(max_size=3),
            inner,
            max_size=4,
        )
    ),
    max_leaves=8,
)
PLACES = sorted({place for place, *_ in BAD})


@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.tuples(st.sampled_from(PLACES), SCRAPS), min_size=1, max_size=2))
def test_whatever_is_written_loads_or_is_refused_in_one_line(tmp_path, changes):
    content = plain()
    for place, value in changes:
        *parents, last = [int(part) if part.isdigit() else part for part in place.split(".")]
        target = content
        try:
            for part in parents:
                target = target[part]
            target[last] = value
        except (TypeError, KeyError, IndexError):
            continue
    told = ""
    try:
        written(tmp_path, yaml.safe_dump(content, allow_unicode=True).encode("utf-8", "replace"))
    except InputError as error:
        told = str(error)
    assert "\n" not in told


@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.text(max_size=60) | st.binary(max_size=60).map(lambda raw: raw.decode("latin-1")))
def test_no_text_is_a_task(tmp_path, text):
    with pytest.raises(InputError):
        written(tmp_path, text.encode("utf-8", "replace"))

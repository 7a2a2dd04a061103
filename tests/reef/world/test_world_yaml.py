"""World files as text: what is read as a mapping, what is refused, and how a world is written."""

import pytest
import yaml

from coral.errors import InputError
from coral.reef.world.world_yaml import read_mapping, to_text


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


def test_a_date_is_text_as_in_yaml_1_2(tmp_path):
    (tmp_path / "w.yaml").write_text("when: 2026-13-45")
    assert read_mapping(tmp_path / "w.yaml") == {"when": "2026-13-45"}


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    for path, found in ((tmp_path / "none.yaml", "no such file"), (tmp_path, "a folder")):
        with pytest.raises(InputError, match=found):
            read_mapping(path)


WORLD = {
    "name": "a: b, [c]",
    "size_m": [10.0, 12.5],
    "clusters": [{"name": "10", "oysters": [{"x": 5.0, "radii": [0.1, 0.1, 0.05]}, {"x": 5.1234567}]}],
    "obstacles": [{"shape": "box", "yaw": -0.0001}],
    "spine": [],
    "seed": 7,
}


def test_a_world_is_written_with_one_object_to_a_line_and_the_long_lists_last():
    assert to_text(WORLD, ["made by hand", ""]) == (
        "# made by hand\n"
        "#\n"
        "name: 'a: b, [c]'\n"
        "size_m: [10.0, 12.5]\n"
        "seed: 7\n"
        "spine: []\n"
        "clusters:\n"
        "  - name: '10'\n"
        "    oysters:\n"
        "      - {x: 5.0, radii: [0.1, 0.1, 0.05]}\n"
        "      - {x: 5.123}\n"
        "obstacles:\n"
        "  - {shape: box, yaw: 0.0}\n"
    )


def test_what_is_written_is_read_as_it_was_but_for_the_rounding(tmp_path):
    (tmp_path / "w.yaml").write_text(to_text(WORLD), encoding="utf-8")
    rounded = yaml.safe_load(yaml.safe_dump(WORLD))
    rounded["clusters"][0]["oysters"][1]["x"], rounded["obstacles"][0]["yaw"] = 5.123, 0.0
    assert read_mapping(tmp_path / "w.yaml") == rounded

"""YAML of other people: what only a file written to do harm holds is one line, at once, and never a crash."""

import contextlib
import json
import math
import os
import resource
import subprocess
import sys

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from coral.errors import InputError

READERS = (
    ["reef", "run"],
    ["contact", "run"],
    ["reef", "run", "s1", "--config"],
    ["contact", "run", "pick-box", "--config"],
)
DEEP = {
    "brackets": "[" * 30_000,
    "closed brackets": "a: " + "[" * 30_000 + "]" * 30_000,
    "braces": "{a: " * 10_000,
    "brackets beside text that closes them": 'a: ["]",' * 10_000,
    "dashes": "- " * 30_000,
    "questions": "? " * 30_000,
    "lines": "".join(" " * k + "a:\n" for k in range(2000)),
}


BOMB = "a0: &a0 {" + ", ".join(f"k{i}: 1" for i in range(9)) + "}\n"
BOMB += "".join(f"a{n}: &a{n} {{<<: [{', '.join([f'*a{n - 1}'] * 9)}]}}\n" for n in range(1, 8))
TOLD = {
    "deep.yaml": "deep.yaml: line 1: found values nested more than",
    "bomb.yaml": "found more than 500000 values",
    "pipe.yaml": "expected a regular file",
    "link.yaml": "expected a regular file",
    "/dev/zero": "expected a regular file",
}
COMMANDS = """
import contextlib, io, json, sys
from coral.cli import main
for words in json.load(sys.stdin):
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
        code = main(words)
    print(json.dumps([code, out.getvalue(), err.getvalue()]), flush=True)
"""


def test_a_file_made_to_harm_is_one_line_for_every_command_that_reads_one(tmp_path):
    """In a process of its own, since some used to end by a signal, to hang or to take all memory."""
    (tmp_path / "deep.yaml").write_text(DEEP["brackets"])
    (tmp_path / "bomb.yaml").write_text(BOMB)
    os.mkfifo(tmp_path / "pipe.yaml")
    (tmp_path / "link.yaml").symlink_to("/dev/zero")
    words = [[*command, str(tmp_path / name), "--out", str(tmp_path / "new")] for command in READERS for name in TOLD]
    done = subprocess.run(
        [sys.executable, "-c", COMMANDS],
        input=json.dumps(words),
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (8_000_000_000, 8_000_000_000)),
    )
    ends = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(ends) == len(words), (words[len(ends)], done.returncode, done.stderr[-2000:])
    for asked, (code, out, err) in zip(words, ends, strict=True):
        told = TOLD[asked[-3].removeprefix(f"{tmp_path}/")]
        assert (code, out, err.count("\n"), told in err) == (2, "", 1, True), (asked, err)
    assert not (tmp_path / "new").exists()


@pytest.fixture
def load(tmp_path):
    from coral.foreign_file import read_text
    from coral.yaml_file import load_mapping

    def go(text):
        file = tmp_path / "file.yaml"
        file.write_text(text, encoding="utf-8")
        return load_mapping(read_text(file, "a file"), str(file), 1000)

    return go


@pytest.mark.parametrize("what", DEEP)
def test_every_kind_of_nesting_is_limited(load, what):
    with pytest.raises(InputError, match="nested more than 50 deep"):
        load(DEEP[what])


def test_what_people_nest_is_read(load):
    deep = "".join(" " * k + "a:\n" for k in range(45))
    assert load("x: [[[[1, 2]]]]")["x"] == [[[[1, 2]]]]
    assert list(load(deep)) == ["a"]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("[" + "1, " * 3001 + "1]", "more than 1000 values"),
        ("a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "b: [" + "*a, " * 400 + "*a]", "more than 1000 values"),
        ("a: 1\na: 2", "the key 'a' twice"),
        ("[1, 2]", "a list"),
        ("a: [1", "line 2: a ',' or ']' is missing"),
        ("a: 1\n---\nb: 2", "a second document"),
        ("? [1]\n: 2", "unhashable"),
        ("? {a: 1}\n: 2", "unhashable"),
        ("!!python/object:os.system {}", "could not determine a constructor"),
    ],
)
def test_other_faults_are_one_line(load, text, found):
    with pytest.raises(InputError, match=found) as error:
        load(text)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0120", 120),
        ("8e-1", 0.8),
        ("0x1f", 31),
        ("0o17", 15),
        ("-5", -5),
        ("+.5", 0.5),
        ("1.", 1.0),
        ("1.5e3", 1500.0),
        ("-.inf", -math.inf),
        ("1:30", "1:30"),
        ("1_000", "1_000"),
        ("2026-13-45", "2026-13-45"),
        ("'8e-1'", "8e-1"),
        ("yes", True),
    ],
)
def test_numbers_are_those_of_yaml_1_2(load, text, value):
    found = load(f"\ufeffa: {text}")["a"]
    assert found == value
    assert type(found) is type(value)


@settings(max_examples=200, deadline=None)
@given(st.from_regex(r"[-+.0-9eExo_:]{1,8}", fullmatch=True) | st.floats(allow_nan=False) | st.integers() | st.text())
def test_what_is_written_is_read_as_the_same_value_by_both_versions(value):
    from coral.yaml_file import load_mapping, to_yaml

    text = to_yaml({"a": value})
    if "\x85" not in text and not any("\ud800" <= c <= "\udfff" for c in str(value)):
        assert load_mapping(text, "file") == {"a": value} == yaml.safe_load(text)


def test_a_merge_key_is_read_and_a_value_inside_itself_is_not(load):
    assert load("a: &a {b: 1}\nc: {<<: *a, d: 2}")["c"] == {"b": 1, "d": 2}
    with pytest.raises(InputError, match=r"line 1: found \*a inside itself"):
        load("a: &a [*a]")


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(st.characters(codec="utf-8"), max_size=9),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=4),
    max_leaves=12,
)


@settings(max_examples=60, deadline=None)
@given(st.one_of(VALUES.map(lambda value: yaml.safe_dump(value, allow_unicode=True)), st.text(max_size=60)))
def test_any_text_is_a_mapping_or_one_line(text):
    from coral.yaml_file import load_mapping

    with contextlib.suppress(InputError):
        assert isinstance(load_mapping(text, "file", 1000), dict)

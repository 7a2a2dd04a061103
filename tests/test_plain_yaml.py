"""One pass over the events gives what PyYAML's safe loader gives, or leaves the text to it."""

import math

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from coral.plain_yaml import build_plain
from coral.yaml_file import Loader

SCALARS = ["1", "-1.50", "01.5", "1_0.5", "1e3", "1.e+3", ".5", "+.inf", ".NaN", "0x1F", "017", "0b11", "190:20:30"]
SCALARS += ["190:20.5", "yes", "Off", "null", "~", "", "text", "'1'", '"yes"', "1.5m", "1.5\n", "٣.٥", "-", "=", "<<"]


def built(text):
    return build_plain(yaml.parse(text, Loader=Loader), "file", 1000)


def same(a, b):
    if isinstance(a, float) and math.isnan(a):
        return isinstance(b, float) and math.isnan(b)
    if isinstance(a, list):
        return isinstance(b, list) and len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, dict):
        return isinstance(b, dict) and list(a) == list(b) and all(map(same, a.values(), b.values()))
    return type(a) is type(b) and a == b


@pytest.mark.parametrize("scalar", SCALARS)
def test_a_scalar_is_what_pyyaml_makes_of_it(scalar):
    try:
        expected = yaml.load(f"a: {scalar}", Loader=Loader)
    except yaml.YAMLError:
        return  # `load_mapping` would meet the same error
    plain, found = built(f"a: {scalar}")
    assert not plain or same(found, expected)


@pytest.mark.parametrize("text", ["a: [1, 2.5, {b: x}]", "- 1\n- [2]", "", "7", "a:\nb: 'c'"])
def test_plain_documents_are_built(text):
    plain, found = built(text)
    assert plain
    assert same(found, yaml.load(text, Loader=Loader))


@pytest.mark.parametrize(
    "text",
    [
        "a: &x 1",
        "a: &x [1]\nb: *x",
        "a: !!str 1",
        "a: 1\na: 2",
        "? [1]\n: 2",
        "a: 2026-01-02",
        "<<: {a: 1}",
        "{1: 2, '1': 3}",
        "1\n--- 2",
    ],
)
def test_what_is_not_plain_is_left_to_pyyaml(text):
    assert built(text) == (False, None)


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.sampled_from(SCALARS),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5) | st.integers(), inner, max_size=4),
    max_leaves=12,
)


@settings(max_examples=60, deadline=None)
@given(VALUES, st.booleans())
def test_whatever_is_dumped_is_read_as_pyyaml_reads_it(value, flow):
    text = yaml.safe_dump(value, default_flow_style=flow, sort_keys=False, allow_unicode=True)
    plain, found = built(text)
    assert not plain or same(found, yaml.load(text, Loader=Loader))

import dataclasses

import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.campaign.spec import Spec, grid, parse_names, parse_seeds
from coral.errors import InputError

SPEC = Spec(system="reef", variant="full", world="my reefs/l 1.yaml", seed=3, advisor="sloppy:0.3:heuristic")


def test_key_is_readable_unique_and_the_same_in_every_version():
    assert SPEC.key == "l-1.yaml_full_sloppy-0.3-heuristic_s3_01dbb15177"


@pytest.mark.parametrize(
    "change",
    [
        {"variant": "pd"},
        {"world": "l1"},
        {"seed": 4},
        {"advisor": "heuristic"},
        {"system": "contact"},
        {"overrides": (("time_limit_s", 3),)},
    ],
)
def test_every_field_changes_the_key(change):
    assert dataclasses.replace(SPEC, **change).key != SPEC.key


@given(st.text(min_size=1), st.text(), st.integers(0, 10**9))
def test_any_name_makes_a_file_name_and_survives_json(world, advisor, seed):
    spec = dataclasses.replace(SPEC, world=world, advisor=advisor, seed=seed)
    assert Spec.from_json(spec.to_json()) == spec
    assert "/" not in spec.key
    assert not spec.key.startswith(".")
    assert spec.key.isascii()
    assert len(spec.key) < 160


def test_grid_has_every_combination_once_and_asks_no_advisor_twice_for_the_same():
    specs = grid(
        "reef",
        variants=["full", "lawnmower"],
        worlds=["l1", "s1"],
        seeds=[0, 1, 2],
        advisors=["heuristic", "desk"],
        alone={"lawnmower"},
    )
    assert len(specs) == len(set(specs)) == 2 * 3 * (2 + 1)
    assert {s.advisor for s in specs if s.variant == "lawnmower"} == {"none"}


def test_a_sweep_is_a_dimension():
    specs = grid("reef", variants=["full"], worlds=["l1"], seeds=[0], advisors=["a"], overrides=[{"x": 1}, {"x": 2}])
    assert [spec.overrides for spec in specs] == [(("x", 1),), (("x", 2),)]


@pytest.mark.parametrize(("text", "seeds"), [("0-2", (0, 1, 2)), ("7", (7,)), (" 5, 0-1,1 ", (0, 1, 5))])
def test_seeds(text, seeds):
    assert parse_seeds(text) == seeds


@pytest.mark.parametrize("text", ["", "a", "3-1", "-1", "0--3", "1.5", "0,", "0-999999999", "٣"])
def test_bad_seeds_are_refused_in_one_line(text):
    with pytest.raises(InputError, match="--seeds: found"):
        parse_seeds(text)


@pytest.mark.parametrize("text", ["", "a,,b", ","])
def test_empty_names_are_refused(text):
    with pytest.raises(InputError, match="--worlds: found"):
        parse_names(text, "--worlds")


def test_empty_and_absurd_grids_are_refused():
    with pytest.raises(InputError, match="--variants"):
        grid("reef", variants=[], worlds=["l1"], seeds=[0], advisors=["a"])
    with pytest.raises(InputError, match="at most"):
        grid("reef", variants=["a"] * 100, worlds=["l1"] * 100, seeds=range(1000), advisors=["a"])

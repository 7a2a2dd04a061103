"""Kinds of things on the sea floor."""

from __future__ import annotations

import pytest

from coral.errors import InputError
from coral.reef.world.kinds import catalogue, find_kind, grow


@pytest.mark.parametrize("name", list(catalogue().kinds))
def test_every_kind_grows_solids_of_known_looks_on_the_floor(name):
    solids = grow(name, 5.0, 4.0, 0.3, 0.5)
    assert {solid["look"] for solid in solids} <= set(catalogue().looks)
    assert all(0.4 < solid["z"] <= 2.5 and abs(solid["x"] - 5.0) < 2.0 for solid in solids)
    assert solids == grow(name, 5.0, 4.0, 0.3, 0.5)


def test_two_things_of_a_kind_differ():
    here, there = (grow("living-clump", x, 4.0, 0.0, 0.0) for x in (5.0, 6.0))
    assert [one["size"] for one in here] != [one["size"] for one in there]


def test_an_unknown_kind_names_the_nearest():
    with pytest.raises(InputError, match="ghost-net"):
        find_kind("gost-net")

import pytest

from coral.errors import InputError
from coral.reef.networks.class_table import class_table, read_names
from coral.reef.world.geometry import Label


def test_names_say_what_classes_are():
    found = class_table({0: "Rock", 1: "Live_oyster", 2: "sand", 3: "water"}, {}, "f")
    assert found.labels == {0: Label.OBSTACLE, 1: Label.OYSTER, 2: Label.SEABED, 3: Label.WATER}
    assert found.describe() == "0 Rock: obstacle; 1 Live_oyster: oyster; 2 sand: seabed; 3 water: water"


@pytest.mark.parametrize("name", ["oyster drill", "oyster toadfish", "dead oyster", "water bottle", "sand dollar"])
def test_a_name_counts_as_a_whole(name):
    assert class_table({0: name, 1: "oyster"}, {}, "f").labels == {0: Label.OBSTACLE, 1: Label.OYSTER}


def test_what_a_user_states_wins_by_name_and_by_number():
    found = class_table({0: "Bank", 1: "oyster", 2: "clam"}, {"bank": "oyster", 1: "seabed"}, "f")
    assert found.labels == {0: Label.OYSTER, 1: Label.SEABED, 2: Label.OBSTACLE}
    assert class_table({}, {0: "oyster", 1: "seabed"}, "f").labels == {0: Label.OYSTER, 1: Label.SEABED}
    with pytest.raises(InputError, match=r"f: classes\.bnak: found no such class, expected .*did you mean 'Bank'"):
        class_table({0: "Bank", 1: "oyster"}, {"bnak": "oyster"}, "f")


@pytest.mark.parametrize("names", ["oyster", "[1, 2]", "{" * 500])
def test_names_that_are_none_are_one_clear_line(names):
    with pytest.raises(InputError, match=r"f: metadata\.names: found"):
        read_names(names, "f")


def test_a_network_without_oysters_is_refused():
    with pytest.raises(
        InputError, match=r"f: metadata\.names: found fish, expected a class that NAME.eyes.yaml states"
    ):
        class_table({0: "fish"}, {}, "f")

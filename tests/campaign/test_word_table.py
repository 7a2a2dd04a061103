"""The table of missions in words."""

from coral.campaign.spec import NO_ADVISOR
from coral.campaign.word_table import word_tables
from coral.reef.world.word_missions import half_of


def row(world, variant, success, time_s=60.0, spared=True, advisor=NO_ADVISOR):
    conditions = [{"condition": "spared", "met": spared, "found": ""}]
    return {
        "world": world,
        "variant": variant,
        "advisor": advisor,
        "success": success,
        "sim_time_s": time_s,
        "collisions": 0,
        "conditions": conditions,
        "overrides": "{}",
    }


def test_halves_are_apart_and_times_are_over_the_oracle():
    rows = [
        row("words:net:0", "oracle", True, 50.0),
        row("words:net:0", "full", True, 100.0, advisor="heuristic"),
        row("words:net:1", "full", False, spared=False, advisor="heuristic"),
        row("words:net:100", "oracle", True),
        row("s1", "full", None),
    ]
    development, test = word_tables(rows, half_of)
    assert development.rows[0][0] == "oracle"
    assert development.rows[1][1:5] == ("2", "50 [9, 91]", "2.00", "50")
    assert len(test.rows) == 1


def test_there_is_none_without_missions_in_words():
    assert word_tables([row("s1", "full", None)], half_of) == []

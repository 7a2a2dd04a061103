from coral.campaign.measures import field
from coral.campaign.sweep_tables import by_setting, sweep_tables

COVERAGE = field("coverage", "coverage (%)", "coverage", 100.0)
HITS = field("collisions", "collisions", "collisions")


def row(overrides="{}", world="l1", seed=0, coverage=1.0, collisions=0):
    return {
        "variant": "full",
        "world": world,
        "seed": seed,
        "overrides": overrides,
        "coverage": coverage,
        "collisions": collisions,
    }


ROWS = [
    row(overrides, world, seed, coverage, collisions)
    for world in ("l1", "s1")
    for seed in (0, 1)
    for overrides, coverage, collisions in (
        ('{"current": 0.5}', 0.5, 1 + seed),
        ("{}", 1.0, 0),
        ('{"current": 0.1}', 1.0, 0),
    )
]


def test_rows_are_grouped_by_setting_whatever_their_order():
    groups = by_setting(ROWS)
    assert list(groups) == ["nominal", "current=0.1", "current=0.5"]
    assert [len(rows) for rows in groups.values()] == [4, 4, 4]
    assert {row["coverage"] for row in groups["current=0.5"]} == {0.5}


def test_means_stand_with_the_nominal_setting_first():
    means, _ = sweep_tables(ROWS, (COVERAGE, HITS), "Who.", ("From where.",))
    assert means.header == ("setting", "missions", "coverage (%)", "collisions")
    assert means.rows == (
        ("nominal", "4", "100.0 [100.0, 100.0]", "0.0 [0.0, 0.0]"),
        ("current=0.1", "4", "100.0 [100.0, 100.0]", "0.0 [0.0, 0.0]"),
        ("current=0.5", "4", "50.0 [50.0, 50.0]", "1.5 [1.5, 1.5]"),
    )
    assert means.notes[-1] == "From where."


def test_differences_are_paired_with_the_nominal_setting():
    _, differences = sweep_tables(ROWS, (COVERAGE, HITS), "Who.", ())
    assert differences.rows == (
        ("current=0.1", "4", "≈ 0.0 [0.0, 0.0]", "≈ 0.0 [0.0, 0.0]"),
        ("current=0.5", "4", "−50.0 [−50.0, −50.0]", "+1.5 [+1.5, +1.5]"),
    )
    assert any("could be shown for: current=0.1." in note for note in differences.notes)


def test_without_the_nominal_setting_there_are_no_differences():
    rows = [row for row in ROWS if row["overrides"] != "{}"]
    assert [table.name for table in sweep_tables(rows, (COVERAGE,), "Who.", ())] == ["Sweep"]


def test_nothing_swept_makes_no_table():
    assert sweep_tables([row()], (COVERAGE,), "Who.", ()) == []

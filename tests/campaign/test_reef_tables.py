import pytest

from coral.campaign.reef_tables import reef_tables, word_tables
from coral.reef.generator.word_missions import half_of

ABOUT = {"commit": "abc1234", "machine": "x86_64, 2 cores, Linux"}


def mission(variant, world="l1", seed=0, advisor="heuristic", coverage=1.0, **more):
    covered = round(4 * coverage)
    return {
        "system": "reef",
        "variant": variant,
        "world": world,
        "seed": seed,
        "advisor": advisor,
        "overrides": "{}",
        "status": "done",
        "failure": "",
        "code": "c0de",
        "topology": world[0].upper(),
        "coverage": coverage,
        "clusters_covered": covered,
        "clusters_total": 4,
        "collisions": 0,
        "advisor_calls": 10,
        "requeries": 1,
        "deviations": 0,
        "steps": 2000,
        "sim_time_s": 200.0,
        "steps_per_percent": 2000 / (100 * coverage) if coverage else None,
        "distance_m": 40.0,
        "covered_at_s": [30.0 * (k + 1) for k in range(covered)],
        **more,
    }


ROWS = [
    row
    for world in ("l1", "k1")
    for seed in (0, 1)
    for row in (
        mission("full", world, seed),
        mission("dream", world, seed, coverage=0.5, collisions=2 + seed, covered_at_s=[100.0, 300.0]),
        mission("no-ddp", world, seed),
        mission("frontier", world, seed, advisor="none", coverage=0.25, advisor_calls=0),
    )
]


def tables_by_name(rows):
    return {table.name: table for table in reef_tables(rows, ABOUT, "coral reef bench --seeds 0-1")}


def line(table, start):
    row = next(row for row in table.rows if row[0].startswith(start))
    return dict(zip(range(len(row)), row, strict=True))


def test_our_means_stand_beside_the_papers_numbers():
    table = tables_by_name(ROWS)["Table I"]
    assert table.header[2:] == (
        "coverage (%)",
        "paper",
        "coverage time (s)",
        "paper",
        "collisions",
        "paper",
        "advisor calls",
        "paper",
    )
    assert [row[0] for row in table.rows] == ["DREAM", "CORAL (full)"]  # what did not run has no row
    assert table.rows[0] == (
        "DREAM",
        "4",
        "50.0",
        "80.00",
        "300",
        "1513.2 (756.6)",
        "2.50",
        "9 (0.9)",
        "10.0",
        "1261 (126.1)",
    )
    assert table.rows[1][4] == "60", "when the second cluster was covered, as many as DREAM covered"


def test_differences_are_paired():
    tables = tables_by_name(ROWS)
    dream = tables["Table I, differences"].rows[0]
    assert dream == (
        "DREAM",
        "4",
        "−50.0 [−50.0, −50.0]",
        "+240 [+240, +240]",
        "+2.50 [+2.50, +2.50]",
        "≈ 0.0 [0.0, 0.0]",
    )
    assert [row[0] for row in tables["Table II, differences"].rows] == ["w/o DDP"]


def test_topologies_and_worlds():
    tables = tables_by_name(ROWS)
    third = tables["Table III"]
    assert [row[0] for row in third.rows] == ["L-shape", "K-shape", "all missions"]
    assert line(third, "K")[3] == "83.33"
    assert [row[0] for row in tables["By world"].rows] == ["l1", "k1"]


def test_a_variant_without_an_advisor_stands_beside_every_advisor():
    rows = [*ROWS, *(dict(row, advisor="sloppy:malformed=0.3:heuristic") for row in ROWS if row["variant"] == "full")]
    everything = [table for table in reef_tables(rows, ABOUT, "x") if table.name == "All variants"]
    assert len(everything) == 2
    assert all(any(row[0] == "frontier exploration" for row in table.rows) for table in everything)
    assert "simulated mistakes, no foundation model" in everything[1].caption


def test_every_table_says_where_it_comes_from():
    rows = [*ROWS, {**mission("pd"), "status": "failed", "failure": "ValueError"}, mission("pd", seed=1, code="f00d")]
    for table in reef_tables(rows, ABOUT, "coral reef bench --seeds 0-1"):
        text = " ".join(table.notes)
        assert "heuristic (embedded rules, no foundation model)" in table.caption
        for part in (
            "l1, k1",
            "Seeds: 0, 1",
            "abc1234",
            "x86_64",
            "coral reef bench --seeds 0-1",
            "Mixed",
            "Failed and left out (1): pd in l1, seed 0",
        ):
            assert part in text


def test_a_campaign_without_the_reference_or_dream_still_makes_tables():
    names = set(tables_by_name([mission("pd")]))
    assert "Table III" not in names
    assert {"Table I", "All variants"} <= names


JUDGED = [
    mission(variant, world, 0, advisor=advisor, inspected=share, imaged=1.0, time_to_90_s=soon, oracle_ratio_90=ratio)
    for world in ("l1", "k1")
    for variant, advisor, share, soon, ratio in (
        ("full", "heuristic", 0.95, 120.0 if world == "l1" else None, 2.0 if world == "l1" else None),
        ("blind-sweep", "none", 0.4, None, None),
        ("oracle", "none", 1.0, 60.0, 1.0),
    )
]


def test_what_was_inspected_stands_with_the_share_of_missions_that_got_there():
    table = tables_by_name([*JUDGED, mission("pd")])["Inspection"]
    rows = {row[0]: dict(zip(table.header, row, strict=True)) for row in table.rows}
    assert list(rows) == ["CORAL (full)", "blind sweep", "oracle tour (bound)"]  # pd was not judged
    assert rows["CORAL (full)"]["to 90 % (s)"] == "120 (1/2)"
    assert rows["CORAL (full)"]["× oracle, to 90 %"] == "2.00 (1/2)"
    assert rows["blind sweep"]["to 90 % (s)"] == "—"
    assert rows["oracle tour (bound)"]["to 90 % (s)"] == "60 [60, 60]"
    assert any("not a proven optimum" in note for note in table.notes)
    assert "position error (m)" not in table.header, "no mission has that number"
    more = tables_by_name([mission("full", inspected=1.0, position_error_m=0.5)])["Inspection"]
    assert "position error (m)" in more.header


@pytest.mark.parametrize(("count", "time"), [(1, "5"), (3, "40"), (4, "—"), (0, "—"), (None, "—")])
def test_coverage_time_is_when_dreams_count_was_reached(count, time):
    rows = [mission("full", coverage=0.75, covered_at_s=[5.0, 9.0, 40.0])]
    rows += [] if count is None else [mission("dream", coverage=count / 4)]
    assert line(tables_by_name(rows)["Table I"], "CORAL")[4] == time


SWEPT = [
    mission("full", world, seed, coverage=coverage, collisions=hits, overrides=overrides)
    for world in ("l1", "s1")
    for seed in (0, 1)
    for overrides, coverage, hits in (
        ('{"current": 0.5}', 0.5, 1 + seed),
        ("{}", 1.0, 0),
        ('{"current": 0.1}', 1.0, 0),
    )
]


def test_a_sweep_stands_with_the_nominal_setting_first_and_paired_differences_from_it():
    tables = tables_by_name(SWEPT)
    means, differences = tables["Sweep"], tables["Sweep, differences"]
    assert means.header[:3] == ("setting", "missions", "coverage (%)")
    assert [row[:3] for row in means.rows] == [
        ("nominal", "4", "100.0 [100.0, 100.0]"),
        ("current=0.1", "4", "100.0 [100.0, 100.0]"),
        ("current=0.5", "4", "50.0 [50.0, 50.0]"),
    ]
    assert [row[:3] for row in differences.rows] == [
        ("current=0.1", "4", "≈ 0.0 [0.0, 0.0]"),
        ("current=0.5", "4", "−50.0 [−50.0, −50.0]"),
    ]


def test_without_the_nominal_setting_there_are_no_differences_and_nothing_swept_makes_no_table():
    rows = [row for row in SWEPT if row["overrides"] != "{}"]
    assert set(tables_by_name(rows)) == {"Sweep"}
    assert "Sweep" not in tables_by_name(ROWS)


def in_words(world, variant, success, time_s=60.0, spared=True, advisor="none"):
    conditions = [{"condition": "spared", "met": spared, "found": ""}]
    return mission(variant, world, 0, advisor, success=success, sim_time_s=time_s, conditions=conditions)


def test_missions_in_words_have_their_halves_apart_and_times_over_the_oracle():
    rows = [
        in_words("words:net:0", "oracle", True, 50.0),
        in_words("words:net:0", "full", True, 100.0, advisor="heuristic"),
        in_words("words:net:1", "full", False, spared=False, advisor="heuristic"),
        in_words("words:net:100", "oracle", True),
        in_words("s1", "full", None),
    ]
    development, test = word_tables(rows, half_of)
    assert development.rows[0][0] == "oracle"
    assert development.rows[1][1:] == ("1/2", "9–91", "2.00", "50", "—", "0")
    assert len(test.rows) == 1
    assert word_tables([in_words("s1", "full", None)], half_of) == []

import json

from coral.campaign.columns import Group
from coral.campaign.reef_tables import RESTRICTED, reef_tables

ABOUT = {"commit": "abc1234", "machine": "x86_64, 2 cores, Linux"}


def mission(variant, world, preset="clear", advisor="heuristic", soon=200.0, **more):
    return {
        "system": "reef",
        "variant": variant,
        "world": world,
        "seed": 0,
        "advisor": advisor,
        "overrides": json.dumps({} if preset == "clear" else {"preset": preset}),
        "setting": "",
        "status": "done",
        "failure": "",
        "code": "c0de",
        "topology": world[0].upper(),
        "inspected": 0.95 if soon is not None else 0.5,
        "time_to_90_s": soon,
        "oracle_ratio_90": soon / 50.0 if soon is not None else None,
        "coverage": 1.0,
        "clusters_covered": 4,
        "idle_fraction": 0.25,
        "collisions": 1,
        "path_deviations": 2,
        "advisor_calls": 8,
        "requeries": 0,
        "deviations": 0,
        "sim_time_s": 300.0,
        "steps_per_percent": 30.0,
        "distance_m": 90.0,
        "covered_at_s": [1.0, 2.0, 3.0, 4.0],
        "answers": json.dumps({"accepted": 6, "refused": 2, "malformed": 0, "missing": 0}),
        "decided_by": json.dumps({"advisor": 6, "fallback": 0}),
        "fallback": "hold",
        **more,
    }


ROWS = [
    row
    for preset, factor in (("clear", 1.0), ("hard", 2.0))
    for world in ("l1", "s1", "k1")
    for row in (
        mission("full", world, preset, soon=100.0 * factor),
        mission("full", world, preset, advisor="sloppy:0.6:heuristic", soon=150.0 * factor),
        mission("no-verification", world, preset, soon=None if preset == "hard" else 140.0),
        mission("no-verification", world, preset, advisor="sloppy:0.6:heuristic", soon=None),
        mission("dream", world, preset, soon=None),
        mission("blind-sweep", world, preset, advisor="none", soon=None, answers="{}", decided_by="{}"),
        mission("oracle", world, preset, advisor="none", soon=50.0, answers="{}", decided_by="{}"),
    )
]


def tables():
    return reef_tables(ROWS, ABOUT, "coral reef bench --study")


def inspection():
    table = next(table for table in tables() if table.name == "Inspection")
    return {row[0]: dict(zip(table.header, row, strict=True)) for row in table.rows}


def test_every_preset_and_advisor_has_the_papers_tables_and_what_was_inspected():
    for name in ("Table I", "Table II", "Table III", "Inspection"):
        captions = [table.caption for table in tables() if table.name == name]
        found = {(p, a) for c in captions for p in ("clear", "hard") for a in ("heuristic (", "sloppy:0.6")
                 if f"Advisor: {a}" in c and c.endswith(f"Preset: {p}.")}  # fmt: skip
        assert len(found) == len(captions) == 4


def test_the_references_are_rows_of_every_table_of_variants():
    for table in tables():
        if table.name in ("Table I", "Table II", "Inspection", "All variants"):
            assert [row[0] for row in table.rows][-2:] == ["blind sweep", "oracle tour (bound)"]


def test_means_stand_with_their_intervals():
    row = inspection()["CORAL (full)"]
    assert row["inspected (%)"] == "95.0 [95.0, 95.0]"
    assert row["× oracle, to 90 %"] == "2.00 [2.00, 2.00]"
    assert row["answers refused (%)"] == "25.0 [25.0, 25.0]"
    assert row["missions"] == "3"


def test_differences_tell_what_was_inspected_too():
    table = next(table for table in tables() if table.name == "Table II, differences")
    row = dict(zip(table.header, next(row for row in table.rows if row[0].startswith("w/o self")), strict=True))
    assert row["Δ to 90 %, at most 600 s (s)"] == "+40 [+40, +40]"


def test_a_mission_that_never_gets_there_counts_with_the_horizon():
    never, late, soon = (mission("full", "l1", soon=value) for value in (None, 700.0, 90.0))
    assert [RESTRICTED.of(row) for row in (never, late, soon)] == [600.0, 600.0, 90.0]
    assert RESTRICTED.of({}) is None
    own = [row for row in ROWS if row["variant"] == "no-verification" and row["overrides"] != "{}"]
    assert RESTRICTED.mean().text(Group("", own[:3])).startswith("600")


def test_effects_put_all_conditions_side_by_side():
    effects = tables()[-1]
    assert effects.name == "Effects"
    assert effects.header[1:] == (
        "clear, heuristic",
        "clear, sloppy:0.6:heuristic",
        "hard, heuristic",
        "hard, sloppy:0.6:heuristic",
    )
    row = next(row for row in effects.rows if row[0] == "w/o self-verification")
    assert [cell.split(" [")[0] for cell in row[1:]] == ["+40", "+450", "+400", "+300"]


def test_a_check_stands_beside_itself_left_out_and_worse_missions_are_counted():
    rows = [row for row in ROWS if row["overrides"] == "{}"]
    rows += [mission("clairvoyant", world, advisor="none", soon=70.0) for world in ("l1", "s1")]
    without = {"l1": 50.0, "s1": 65.0}
    rows += [mission("clairvoyant-unchecked", world, advisor="none", soon=soon) for world, soon in without.items()]
    table = next(table for table in reef_tables(rows, ABOUT, "coral reef bench") if table.name == "Verification")
    found = {row[0]: dict(zip(table.header, row, strict=True)) for row in table.rows}
    assert set(found) == {"CORAL (full)", "clairvoyant advisor"}
    one = found["clairvoyant advisor"]
    assert (one["pairs"], one["worse missions"]) == ("2", "1")
    assert (one["to 90 %, at most 600 s (s)"], one["to 90 %, at most 600 s (s), without"]) == ("70", "58")
    assert found["CORAL (full)"]["worse missions"] == "0"

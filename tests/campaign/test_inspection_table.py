from coral.campaign.inspection_table import inspection_table


def mission(world, **judged):
    return {"world": world, "seed": 0, **judged}


BY_VARIANT = {
    "full": [
        mission("l1", inspected=0.95, time_to_90_s=120.0, oracle_ratio_90=2.0),
        mission("k1", inspected=0.85, time_to_90_s=None, oracle_ratio_90=None),
    ],
    "blind-sweep": [mission(world, inspected=0.4, time_to_90_s=None) for world in ("l1", "k1")],
    "oracle": [mission(world, inspected=1.0, time_to_90_s=60.0) for world in ("l1", "k1")],
    "unjudged": [mission("l1", inspected=None, position_error_m=None)],
}


def table(by_variant):
    groups = {variant.upper(): rows for variant, rows in by_variant.items()}
    return inspection_table(groups, "Who.", ("From where.",))


def test_means_stand_with_the_share_of_missions_that_got_there():
    found = table(BY_VARIANT)
    rows = {row[0]: dict(zip(found.header, row, strict=True)) for row in found.rows}
    assert list(rows) == ["FULL", "BLIND-SWEEP", "ORACLE"]
    assert rows["FULL"]["inspected (%)"] == "90.0 [85.0, 95.0]"
    assert rows["FULL"]["to 90 % (s)"] == "120 (1/2)"
    assert rows["FULL"]["× oracle, to 90 %"] == "2.00 (1/2)"
    assert rows["BLIND-SWEEP"]["to 90 % (s)"] == "—"
    assert rows["ORACLE"]["to 90 % (s)"] == "60 [60, 60]"


def test_numbers_that_no_mission_has_make_no_column():
    assert "position error (m)" not in table(BY_VARIANT).header
    more = {"full": [mission("l1", inspected=1.0, position_error_m=0.5)]}
    assert "position error (m)" in table(more).header


def test_the_bound_is_explained_and_the_source_comes_last():
    notes = table(BY_VARIANT).notes
    assert any("not a proven optimum" in note for note in notes)
    assert notes[-1] == "From where."


def test_missions_that_were_not_judged_make_no_row():
    assert table({"full": [mission("l1")]}).rows == ()

"""Water and sensors as a dimension of a campaign."""

import json

from coral.campaign.presets import by_preset, with_presets


def test_every_setting_is_run_in_every_water_and_clear_water_needs_no_key():
    assert with_presets(["clear", "hard"], [{}, {"current": 0.2}]) == (
        {},
        {"current": 0.2},
        {"preset": "hard"},
        {"preset": "hard", "current": 0.2},
    )


def test_rows_are_grouped_by_water_and_lose_its_key():
    rows = [
        {"id": 0, "overrides": "{}"},
        {"id": 1, "overrides": json.dumps({"preset": "hard", "current": 0.2})},
        {"id": 2, "overrides": json.dumps({"preset": "hard"})},
    ]
    found = by_preset(rows)
    assert {preset: [row["id"] for row in group] for preset, group in found.items()} == {"clear": [0], "hard": [1, 2]}
    assert json.loads(found["hard"][0]["overrides"]) == {"current": 0.2}
    assert found["hard"][1]["setting"] == found["clear"][0]["setting"]
    assert rows[1]["overrides"] == json.dumps({"preset": "hard", "current": 0.2})  # the rows stay as they were

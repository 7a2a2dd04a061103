from coral.campaign.contact_ablation import ablations


def row(variant, seed, steps, task="flip-wall", **fields):
    return {
        "world": task,
        "variant": variant,
        "seed": seed,
        "advisor": "heuristic",
        "status": "done",
        "evaluation_world": "hand",
        "success": True,
        "steps": steps,
        "path_length_m": steps / 100,
        "first_touch_s": 1.0,
        "plan_cost": 2.0,
        "plan_cost_jump": None,
        "poses": "ground-truth",
        **fields,
    }


ROWS = [
    row("full", 0, 100),
    row("full", 1, 120),
    row("full", 2, 140),
    row("unguided", 0, 200),
    row("unguided", 1, 240, success=False),
    row("unguided", 3, 999),
]


def test_trials_are_compared_on_the_seeds_that_both_have():
    (table,) = ablations(ROWS, "coral contact bench")
    assert "Seeds: 0, 1." in table.notes[-1]


def test_the_plan_without_guidance_stands_between_where_it_was_run():
    (table,) = ablations([*ROWS, row("no-regions", 0, 160), row("no-regions", 1, 180)], "coral contact bench")
    assert [line[0] for line in table.rows][:3] == ["with contact strategy", "its plan, samples unguided", "without"]
    assert table.rows[1][2] == "170"


def test_medians_stand_beside_the_papers_with_their_change():
    (table,) = ablations(ROWS, "coral contact bench")
    lines = {line[0]: line[1:] for line in table.rows}
    assert lines["with contact strategy"] == ("2/2", "110", "1.10", "1.00", "2.00", "–")
    assert lines["without"] == ("1/2", "220", "2.20", "1.00", "2.00", "–")
    assert lines["change"][1:3] == ("-50 %", "-50 %")
    assert lines["change"][4:] == ("–", "–"), "costs of different functions do not compare"
    assert lines["paper, change"][1:3] == ("-83.9 %", "-63.9 %")


def test_other_tasks_stand_alone_and_one_variant_makes_no_table():
    (table,) = ablations([row("full", 0, 10, "flip-box"), row("unguided", 0, 20, "flip-box")], "c")
    assert not any(line[0].startswith("paper") for line in table.rows)
    assert ablations([row("full", 0, 10)], "c") == []

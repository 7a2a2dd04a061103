import json

from coral.campaign.contact_tables import contact_tables


def row(task="pick-box", variant="expert-fsm", seed=0, success=True, place="panda", advisor="none", **fields):
    return {
        "system": "contact",
        "world": task,
        "variant": variant,
        "seed": seed,
        "advisor": advisor,
        "status": "done",
        "overrides": json.dumps({"world": place}),
        "evaluation_world": place,
        "success": success,
        "end_reason": "success" if success else "timeout",
        "sim_time_s": 4.0 + seed,
        "wall_time_s": 10.0,
        "path_length_m": 0.5,
        "peak_hand_force_n": 12.0,
        "plan_ms_median": 80.0,
        "poses": "ground-truth",
        "code": "abc",
        **fields,
    }


ROWS = [row(seed=0), row(seed=1, success=False), row(seed=2), row("push-force", seed=0, success=False)]


def tables(rows=ROWS):
    return contact_tables(rows, {"commit": "1234", "machine": "m"}, "coral contact bench")


def cells(table, method):
    (line,) = [line for line in table.rows if line[0] == method]
    return dict(zip(_unique(table.header), line, strict=True))


def _unique(header):
    return [f"{header[k - 1]}, paper" if label == "paper" else label for k, label in enumerate(header)]


def test_success_is_counted_beside_the_papers():
    found = cells(tables()[0], "expert, state machine")
    assert found["T2 pick box"] == "2/3"
    assert found["T2 pick box, paper"] == "10/10"
    assert found["T4 push with constant force"] == "0/1"
    assert cells(tables()[0], "w/o memory")["T2 pick box"] == "not run"


def test_times_are_means_of_the_successes_alone():
    found = cells(tables()[1], "expert, state machine")
    assert found["T2 pick box (s)"] == "5.0 (10.0)"
    assert found["T2 pick box (s), paper"] == "40"
    assert found["T4 push with constant force (s)"] == "–"


def test_failures_are_told_by_their_reason():
    found = cells(tables()[2], "expert, state machine, pick-box")
    assert found["otherwise ended by"] == "timeout 1"
    assert found["success"] == "2/3"


def test_another_tracker_than_the_embedded_one_is_named_below():
    for fields, said in (
        ({}, "ground-truth"),
        ({"poses": "tracked"}, "tracked"),
        ({"poses": "tracked", "tracker": "model"}, "tracked"),
        ({"poses": "tracked", "tracker": "foundationpose"}, "tracked (foundationpose)"),
    ):
        assert f"Object poses: {said}. " in " ".join(tables([row(**fields)])[0].notes)


def test_worlds_have_tables_of_their_own():
    captions = [table.caption for table in tables([*ROWS, row(place="hand")])]
    assert len(captions) == 8
    assert sum("World: hand." in caption for caption in captions) == 4


def test_a_task_of_ones_own_stands_behind_the_papers():
    header = tables([row("mine/stack.yaml"), *ROWS])[0].header
    assert header[-2:] == ("stack", "paper")
    assert header[1] == "T2 pick box"


def test_trials_that_broke_off_are_named():
    broken = {
        key: value for key, value in row(seed=7).items() if key in ("world", "variant", "seed", "advisor", "overrides")
    }
    notes = tables([*ROWS, {**broken, "status": "failed"}])[0].notes
    assert "Failed and left out (1): expert-fsm in pick-box, seed 7." in notes


def test_what_broke_off_is_told_where_it_belongs():
    broken = {
        key: value
        for key, value in row(advisor="b", variant="full", seed=7).items()
        if key in ("world", "variant", "seed", "advisor", "overrides")
    }
    made = tables([row(advisor="a", variant="full"), {**broken, "status": "failed"}])
    assert [("Advisor: a." in table.caption, any("left out" in note for note in table.notes)) for table in made] == [
        (True, False)
    ] * 4 + [(False, True)] * 2


def test_who_decided_has_a_table_and_marks_what_nobody_or_a_fallback_did():
    by = {"advisor": 2, "memory": 0, "recording": 0, "fallback": 1}
    asked = row(variant="full", advisor="a", decided_by=json.dumps(by), fallback="hold")
    none = row(variant="expert-fsm", decided_by=json.dumps(dict.fromkeys(by, 0)))
    success, _, each, _, decided = tables([asked, none])
    assert cells(success, "CoRAL (full) §")["T2 pick box"] == "1/1"
    assert cells(each, "CoRAL (full), pick-box §")["by fallback (%)"] == "33.3"
    found = cells(decided, "CoRAL (full) §")
    assert (found["decisions"], found["by advisor"], found["by fallback"]) == ("3", "2 (67 %)", "1 (33 %)")
    assert cells(decided, "expert, state machine")["decisions"] == "0"
    assert any("left undecided by the advisor" in note for note in success.notes)


def trial(variant, seed, success, time_s=5.0, calls=2):
    return row(variant=variant, seed=seed, success=success, advisor="a", sim_time_s=time_s, advisor_calls=calls)


def against(rows):
    return next((table for table in tables(rows) if table.name.startswith("Against")), None)


def test_variants_are_compared_trial_by_trial_with_full():
    full = [trial("full", seed, seed != 3) for seed in range(4)]
    other = [trial("unified", 0, True, 9.0), trial("unified", 1, False), trial("unified", 3, True, calls=8)]
    first, second = against([*full, *other]).rows
    assert first == ("CoRAL (full)", "3/4", "30–95", "–", "–", "–", "–", "2.0", "5.0")
    assert second[:2] == ("unified VLM", "2/3")
    assert second[3:] == ("1 : 1", "1", "2 : 1", "1", "4.0", "7.0")


def test_who_is_sooner_counts_a_failure_as_later_and_equal_times_not_at_all():
    full = [trial("full", seed, True, 5.0) for seed in range(8)]
    other = [trial("no-memory", seed, seed < 7, 6.0 if seed < 6 else 5.0) for seed in range(8)]
    assert against([*full, *other]).rows[1][3:7] == ("1 : 0", "1", "7 : 0", "0.016")


def test_without_full_or_without_another_variant_there_is_nothing_to_compare():
    assert against([trial("unified", 0, True), trial("unguided", 0, True)]) is None
    assert against([trial("full", 0, True)]) is None


def strategy(variant, seed, steps, task="flip-wall", **fields):
    measured = {"path_length_m": steps / 100, "first_touch_s": 1.0, "plan_cost": 2.0, "plan_cost_jump": None}
    return row(task, variant, seed, place="hand", advisor="a", steps=steps, **{**measured, **fields})


STRATEGIES = [
    strategy("full", 0, 100),
    strategy("full", 1, 120),
    strategy("full", 2, 140),
    strategy("unguided", 0, 200),
    strategy("unguided", 1, 240, success=False),
    strategy("unguided", 3, 999),
]


def ablation(rows):
    return next((table for table in tables(rows) if table.name == "Contact-strategy ablation"), None)


def test_the_ablation_has_medians_over_the_seeds_that_both_have_beside_the_papers():
    table = ablation(STRATEGIES)
    assert any("Seeds: 0, 1." in note for note in table.notes)
    assert table.header[1:8] == ("success", "steps", "Δ steps (%)", "paper", "path (m)", "Δ path (%)", "paper")
    guided, unguided = (line[1:] for line in table.rows)
    paper_s = ("32 (−83.9 %)", "1.33 (−63.9 %)")
    assert guided == ("2/2", "110", "−50", paper_s[0], "1.10", "−50", paper_s[1], "1.00", "0", "2.00", "–")
    assert unguided == ("1/2", "220", "–", "199", "2.20", "–", "3.69", "1.00", "–", "2.00", "–")


def test_the_plan_without_guidance_stands_between_where_it_was_run():
    table = ablation([*STRATEGIES, strategy("no-regions", 0, 160), strategy("no-regions", 1, 180)])
    assert [line[0] for line in table.rows] == ["CoRAL (full)", "w/o guided sampling", "w/o contact strategy"]
    assert table.rows[1][2] == "170"


def test_other_tasks_have_no_number_of_the_paper_and_one_variant_makes_no_ablation():
    table = ablation([strategy("full", 0, 10, "flip-box"), strategy("unguided", 0, 20, "flip-box")])
    assert table.rows[0][4] == "–"
    assert ablation([strategy("full", 0, 10)]) is None

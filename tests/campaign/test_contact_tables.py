import json

import pytest

from coral.campaign.contact_tables import contact_tables, paper, short_name
from coral.campaign.table import document


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
    ] * 4 + [(False, True)] * 4


def test_the_papers_table_is_complete():
    assert all(len(line) == len(paper()["tasks"]) == 6 for line in paper()["1"].values())
    assert all(
        0 <= count <= 10 and (seconds is None) == (count == 0)
        for line in paper()["1"].values()
        for count, seconds in line
    )


@pytest.mark.parametrize("form", ["md", "tex", "html"])
def test_every_form_holds_the_numbers(form):
    assert "2/3" in document(tables(), form, "Contact tasks")


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


def test_a_benchmarks_scene_keeps_its_name():
    assert short_name("libero:object-swap/3") == "libero:object-swap/3"
    assert short_name("my/tasks/stack.yaml") == "stack"

import pytest

from coral.advisor import prompt
from coral.advisor.prompt import kinds, render, render_rejections, version
from coral.advisor.question import Rejection
from coral.errors import InputError

POSE = [0.5, 0.0, 0.02, 1, 0, 0, 0]
AHEAD = {
    "step_m": 6,
    "facts": {"arrival": {"in_s": 11.0}, "failed": {"index": 4, "cause": "obstacles were in the way"}},
    "latency_s": 10.0,
    "inspect_m": 2.3,
}
WORLD = {
    "task": "push it",
    "scene": "The board lies at 0.5.",
    "hand": "Two fingers.",
    "planner": "1 s ahead.",
    "interface": "self.board_pos",
    "contact_strategy": True,
    "staged": True,
}
CONTEXT = {
    "reef-centroid": AHEAD,
    "reef-waypoint": AHEAD,
    "reef-mission": AHEAD
    | {
        "facts": {
            **AHEAD["facts"],
            "mission": {
                "instruction": "Find the ghost net.",
                "time_s": 180.0,
                "at_s": 40.0,
                "home": {"forward_m": -3.0, "left_m": 1.0},
                "found": [{"dot": 2, "label": "tyre"}],
                "ruled_out": [2, 5],
                "without_dot": [{"forward_m": 1.5, "left_m": -2.0, "name": "crab pot, ruled out"}],
                "area_m": [26.0, 20.0],
                "place": {"east_m": 8.1, "north_m": 9.9},
                "heading_deg": 30,
            },
        }
    },
    "reef-centroid-paper": {"step_m": 6},
    "reef-waypoint-paper": {"step_m": 6},
    "reef-waypoint-without-chain": {"step_m": 6},
    "physical-parameters": {"task": "push it", "objects": {"board": {"pose_estimated": POSE, "mass_kg": None}}},
    "cost-function": WORLD,
    "contact-regions": WORLD,
    "cost-repair": {
        **WORLD,
        "attempts": 3,
        "stage": "go behind",
        "object": "board",
        "diagnosis": "Diagnosis: it slipped.",
        "earlier": ["contact was lost"],
        "regions": ["board: push [0, 0, 0]"],
        "explanation": "It pushes.",
        "evidence": ["The hand touched the board for 40 % of the last 6.0 s."],
        "corrected": ["mass of the board 1 to 2 kg"],
        "advice": ["the cost leads the hand into the wall"],
        "history": [{"time_s": 4.25}],
        "terms": [{"terms": {"reach": 0.75}}],
        "code": "x = 1",
        "error": "x is unknown",
    },
    "parameter-repair": {
        "parameters": {"board": {"mass": 0.4}},
        "object": "board",
        "replayed": [{"expected_moved_mm": [1.5, 0.0, 0.0]}],
        "history": [{"time_s": 4.25}],
    },
    "object-poses": {"task": "push it", "camera": {"focal_px": 500.0}, "table": {}, "objects": {"board": {}}},
    "unified": {
        **WORLD,
        "places": True,
        "code": "x = 1",
        "attempts": 3,
        "diagnosis": "Diagnosis: it slipped.",
        "stage": "go behind",
        "object": "board",
        "earlier": [],
        "evidence": [],
        "corrected": [],
        "advice": [],
        "regions": [],
        "terms": [],
        "explanation": "It pushes.",
        "history": [],
        "error": "x is unknown",
    },
}
TOLD = {
    "reef-centroid": ["about 10 s", "2.3 m or nearer", "obstacles were in the way"],
    "reef-waypoint": ["0 to 6", "about 10 s"],
    "reef-mission": [
        "Find the ghost net.",
        "40 s will have passed",
        "of 180 s",
        "Dot 2: tyre",
        "Ruled out: dots 2, 5",
        "1.5 m forward and -2.0 m to the left: crab pot, ruled out",
        "26.0 m by 20.0 m",
        "8.1 m east and 9.9 m north",
        "30°",
    ],
    "reef-waypoint-paper": ["0, 1, 2, 3, 4, 5, 6 m"],
    "reef-waypoint-without-chain": ["0 to 6"],
    "physical-parameters": ["push it", '"board"'],
    "cost-function": ["push it", "lies at 0.5", "Two fingers", "1 s ahead", "self.board_pos"],
    "contact-regions": ["push it", "lies at 0.5"],
    "cost-repair": [
        "push it",
        "lies at 0.5",
        "x = 1",
        "x is unknown",
        "tried 3 times",
        "Active stage: go behind",
        "it slipped",
        "for 40 %",
        "mass of the board 1 to 2 kg",
        "into the wall",
        "contact was lost",
        "led to board: push",
        "It pushes.",
        "4.25",
        "reach .75",
    ],
    "parameter-repair": ["0.4", "1.5", "4.25"],
    "object-poses": ["push it", "500.0", '"board"'],
    "unified": ["push it", "self.board_pos", "x = 1", "x is unknown", "tried 3 times"],
}
"""What a prompt tells of its context."""


def test_there_is_one_template_per_kind():
    assert set(kinds()) == set(CONTEXT)


@pytest.mark.parametrize("kind", ["reef-centroid", "reef-waypoint"])
def test_doubtful_dots_are_named_only_if_there_are_any(kind):
    dots = [{"index": 4, "doubtful": True}, {"index": 5}, {"index": 7, "doubtful": True}]
    assert "doubtful (4, 7)" in render(kind, AHEAD, facts={**AHEAD["facts"], "centroids": dots})[0]
    assert "doubtful" not in render(kind, AHEAD, facts={**AHEAD["facts"], "centroids": dots[1:2]})[0]


def test_a_question_tells_what_a_reader_could_not_know():
    facts = {
        **AHEAD["facts"],
        "first": {"forward_m": 4, "left_m": -2, "dots": [3, 6]},
        "advice": {"chosen": {"index": 5}, "later_s": 9, "better": 3},
        "guesses": {"right": 1, "wrong": 2, "open": 0, "allowance_s": 24.0},
        "passing": {"dots": [3, 6], "waypoints": [[2, 1]]},
    }
    text = render("reef-waypoint", AHEAD, facts=facts)[0]
    for told in ("Dots are left (3, 6)", "seen 9 s later", "dot 3 first", "1 right, 2 wrong", "up to 24.0 s"):
        assert told in text
    assert "These would pass now:** dots 3, 6; 2 m forward and 1 m left." in text
    silent = render("reef-waypoint", AHEAD)[0]
    assert not any(word in silent for word in ("Advice", "guesses so far", "would pass now", "Why a waypoint"))


def test_without_a_chain_the_prompt_does_not_speak_of_one():
    text = render("reef-waypoint-without-chain", {"step_m": 6})[0].lower()
    assert not [word for word in ("chain", "centroid", "orange", "dots joined", "trend", "cluster") if word in text]


@pytest.mark.parametrize("kind", CONTEXT)
def test_a_prompt_tells_what_it_is_given_and_leaves_no_trace_of_its_template(kind):
    text, stamp = render(kind, CONTEXT[kind])
    assert [phrase for phrase in TOLD.get(kind, ()) if phrase not in " ".join(text.split())] == []
    assert stamp == version(kind)
    assert "{{" not in text
    assert "{%" not in text
    assert "version:" not in text


def test_mapping_and_names_are_the_same():
    assert render("reef-waypoint", AHEAD | {"step_m": 4}) == render("reef-waypoint", AHEAD, step_m=4)
    assert "0 to 4" in render("reef-waypoint", AHEAD, step_m=4)[0]


def test_a_first_question_about_everything_has_an_example_and_a_repair_none():
    first = render("unified", {**CONTEXT["unified"], "code": ""})[0]
    assert ("Example" in first, "How to think" in first, "What happened lately" in first) == (True, True, False)
    assert "Example" not in render("unified", CONTEXT["unified"])[0]


def test_rows_become_a_table_with_one_header():
    rows = [
        {"time_s": 2.0, "pos": [0.0512, -0.12345], "touches": ["left on box", "hand on table"], "cost": None},
        {"time_s": 12.5, "pos": [0.0, 1.0], "touches": [], "terms": {"reach": 0.5, "a": 1e6}},
    ]
    assert prompt.table(rows, "pos").splitlines() == [
        "time_s | touches | cost | terms",
        "2 | left on box, hand on table | none | none",
        "12.5 |  | none | reach .5, a 1e+06",
    ]
    assert ".051 -.123" in prompt.table(rows)


@pytest.mark.parametrize("kind", ["cost-function", "cost-repair", "unified"])
def test_without_a_contact_strategy_a_model_is_told_so(kind):
    told = "nothing of where or how the hand touches"
    assert told not in render(kind, CONTEXT[kind])[0]
    without = render(kind, {**CONTEXT[kind], "contact_strategy": False, "staged": False})[0]
    assert told in without
    assert [word for word in ("`stages`", "stiffness", "back_to") if word in without] == []


def test_optional_parts_leave_no_trace():
    texts = dict.fromkeys(("error", "stage", "diagnosis", "explanation"), "")
    lists = dict.fromkeys(("evidence", "corrected", "advice", "terms", "earlier", "regions", "history"), ())
    text, _ = render("cost-repair", {**CONTEXT["cost-repair"], **texts, **lists})
    words = ("did not even run", "Active stage", "Corrected since", "Noted when", "Largest terms", "author", "led to")
    assert [word for word in (*words, "failed, too", "Last steps") if word in text] == []


def test_the_version_of_a_prompt_covers_the_parts_that_it_includes(monkeypatch, tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "one.md").write_text('{# version: 1 #}\n{% include "parts/a.md" %}\n')
    monkeypatch.setattr(prompt, "FOLDER", tmp_path)
    stamps = set()
    for text in ("x", "y"):
        (tmp_path / "parts" / "a.md").write_text(text)
        version.cache_clear()
        stamps.add(version("one"))
    version.cache_clear()
    assert len(stamps) == 2


def test_unknown_kind_is_suggested():
    with pytest.raises(InputError, match="did you mean 'reef-centroid'"):
        render("reef-centroids")


def test_missing_placeholder_is_named():
    with pytest.raises(InputError, match="step_m"):
        render("reef-waypoint", {key: value for key, value in AHEAD.items() if key != "step_m"})


def test_rejections_in_our_words():
    assert render_rejections([]) == ""
    text = render_rejections([Rejection(code="a", reason="It lies behind."), Rejection(code="b", reason="No dot 9.")])
    assert "1. It lies behind.\n2. No dot 9.\n" in text


def test_the_last_refused_program_is_sent_back_below_its_reason():
    refused = [Rejection(code="a", reason=f"No {k}.", listing=f" 1 | x = {k}") for k in (1, 2)]
    text = render_rejections(refused)
    assert "2. No 2.\nThe refused program:\n```\n 1 | x = 2\n```\n" in text
    assert "x = 1" not in text

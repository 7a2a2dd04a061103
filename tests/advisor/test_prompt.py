import pytest

from coral.advisor.prompt import kinds, render, render_rejections, version
from coral.advisor.question import Rejection
from coral.errors import InputError

POSE = [0.5, 0.0, 0.02, 1, 0, 0, 0]
AHEAD = {
    "step_m": 6,
    "facts": {"arrival": {"in_s": 11.0}, "failed": {"index": 4, "cause": "obstacles were in the way"}},
    "latency_s": 10.0,
    "inspect_m": 2.3,
    "verify": {"enabled": True, "by": "regret"},
    "max_regret_s": 10.0,
}
CONTEXT = {
    "reef-centroid": AHEAD,
    "reef-waypoint": AHEAD,
    "reef-waypoint-without-chain": {"step_m": 6},
    "physical-parameters": {"task": "push it", "objects": {"board": {"pose_estimated": POSE, "mass_kg": None}}},
    "cost-function": {
        "task": "push it",
        "poses": {"board": POSE},
        "parameters": {},
        "interface": "self.board_pos",
        "contact_strategy": True,
    },
    "contact-regions": {"task": "push it", "objects": {"board": POSE}},
    "cost-repair": {
        "task": "push it",
        "attempts": 3,
        "world": {},
        "interface": "",
        "history": [],
        "code": "x = 1",
        "error": "x is unknown",
        "contact_strategy": True,
    },
    "parameter-repair": {"parameters": {"board": {"mass": 0.4}}, "history": []},
    "object-poses": {"task": "push it", "camera": {"focal_px": 500.0}, "table": {}, "objects": {"board": {}}},
    "unified": {
        "task": "push it",
        "objects": {"board": POSE},
        "hand": {},
        "interface": "self.board_pos",
        "places": True,
        "code": "x = 1",
        "attempts": 3,
        "history": [],
        "error": "x is unknown",
    },
}
MUST_SAY = {
    "reef-centroid": [
        "Arrows +X and +Y",
        "Yellow line",
        "Orange dots",
        "White",
        "trend",
        "not on the map",
        "about 10 s",
        "2.3 m or nearer",
        "The last goal failed",
        "obstacles were in the way",
        "more than 10 s on average",
        "selected_centroid_index",
        "null",
        "obstacles",
        "Example",
    ],
    "reef-waypoint": [
        "+X forward",
        "+Y left",
        "-X back",
        "-Y right",
        "0 to 6",
        "about 10 s",
        "tree",
        "more than 10 s on average",
        "forward_m",
        "left_m",
        "Example",
    ],
    "reef-waypoint-without-chain": ["+X forward", "+Y left", "Green", "0 to 6", "forward_m", "left_m", "Example"],
    "physical-parameters": ["push it", "mass_kg", "friction_coeff", '"board"', "picture", "Example"],
    "cost-function": [
        "push it",
        "distance to the goal",
        "contact",
        "orientation",
        "force",
        "effort",
        "time",
        "sigmoid",
        "def state_cost(self):",
        "self.board_pos",
        "Every weight is a number",
        "Simple tasks",
        "Example",
    ],
    "contact-regions": ["push it", "One to three", "center", "normal", "extent", "num_samples", "Example"],
    "cost-repair": ["push it", "x = 1", "x is unknown", "explanation", "tried 3 times", "Example"],
    "parameter-repair": ["physicist", "label", "mass", "friction", "0.4", "Example"],
    "object-poses": ["push it", "picture", "500.0", '"board"', "position", "quaternion", "Example"],
    "unified": [
        "push it",
        "picture",
        "mass_kg",
        "friction_coeff",
        "def state_cost(self):",
        "self.board_pos",
        "regions",
        "x = 1",
        "x is unknown",
        "tried 3 times",
        "explanation",
        "Example",
    ],
}


def test_there_is_one_template_per_kind():
    assert set(kinds()) == set(CONTEXT)


@pytest.mark.parametrize("kind", ["reef-centroid", "reef-waypoint"])
def test_doubtful_dots_are_named_only_if_there_are_any(kind):
    dots = [{"index": 4, "doubtful": True}, {"index": 5}, {"index": 7, "doubtful": True}]
    assert "Doubtful: 4, 7." in render(kind, AHEAD, facts={**AHEAD["facts"], "centroids": dots})[0]
    assert "Doubtful" not in render(kind, AHEAD, facts={**AHEAD["facts"], "centroids": dots[1:2]})[0]


def test_without_a_chain_the_prompt_does_not_speak_of_one():
    text = render("reef-waypoint-without-chain", {"step_m": 6, "others": 1})[0].lower()
    assert not [word for word in ("chain", "centroid", "orange", "dots joined", "trend", "cluster") if word in text]


@pytest.mark.parametrize("kind", CONTEXT)
def test_prompt_holds_every_element_of_the_papers(kind):
    text, stamp = render(kind, CONTEXT[kind])
    lowered = " ".join(text.lower().split())
    assert [phrase for phrase in MUST_SAY[kind] if phrase.lower() not in lowered] == []
    assert stamp == version(kind)
    assert "{{" not in text
    assert "{%" not in text
    assert "version:" not in text


def test_mapping_and_names_are_the_same():
    assert render("reef-waypoint", AHEAD | {"step_m": 4}) == render("reef-waypoint", AHEAD, step_m=4)
    assert "0 to 4" in render("reef-waypoint", AHEAD, step_m=4)[0]


@pytest.mark.parametrize("kind", ["cost-function", "cost-repair"])
def test_without_a_contact_strategy_a_model_is_told_so(kind):
    told = "nothing of where or how the hand touches"
    assert told not in render(kind, CONTEXT[kind])[0]
    assert told in render(kind, {**CONTEXT[kind], "contact_strategy": False})[0]


def test_optional_parts_leave_no_trace():
    text, _ = render("cost-repair", {**CONTEXT["cost-repair"], "error": ""})
    assert "did not even run" not in text
    assert "What the function can use" not in text


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

"""What goes with each question, and what becomes of refused answers; the way through them is in test_thinker.py."""

import dataclasses

import numpy as np
import pytest
from histories import history as steps_of
from pydantic import ValidationError
from recorded import RULES, compose

from coral.advisor.question import AdvisorUnavailable, Picture, Rejection, Reply
from coral.contact.control.hand_controllers import PlannerLimits
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.plan.contact_regions import ObjectRegions, Region, RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer, in_process
from coral.contact.scene.task_names import every_task, suite_tasks
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.diagnosis import TEXTS
from coral.contact.thinker.evidence import collect_evidence
from coral.contact.thinker.questions import Questions, UnifiedAnswer
from coral.contact.thinker.repair_prompt import REPAIR_ROWS
from coral.contact.thinker.strategist import NoStrategy
from coral.contact.thinker.think_cfg import ThinkCfg
from coral.contact.world_model.parameter_estimates import ParameterEstimate

CODE = "def state_cost(self):\n    return norm(self.ee_pos - self.box_pos)"
SIDE = {"center": (0.0, 0.0, 0.5), "normal": (0.0, 0.0, 1.0)}


def limits():
    return PlannerLimits(ControllerCfg(), 0.04, 0.08, arm=True)


class Careless:
    """The default advisor, whose first so many plans read what the state does not have."""

    name = "careless"

    def __init__(self, wrong=0):
        self.wrong, self.questions = wrong, []

    async def answer(self, question, rejections):
        self.questions.append(question)
        if question.kind == "cost-function" and len(rejections) < self.wrong:
            return Reply(value=PlanAnswer(code="def state_cost(self):\n    return self.cup_pos[0]"), raw="")
        return Reply(value=RULES[question.kind](question.facts, ()), raw="")

    def asked(self, kind):
        return next(question for question in reversed(self.questions) if question.kind == kind)


class Unplanned(Careless):
    """An advisor that answers the questions about parameters only."""

    async def answer(self, question, rejections):
        if question.kind == "physical-parameters":
            return await super().answer(question, rejections)
        self.questions.append(question)
        raise AdvisorUnavailable("silent", "no answer", final=True)


@pytest.fixture
def ask(scene):
    def make(advisor, task="pick-box", **cfg):
        one, told = scene(task), []
        questions = Questions(
            Asker(advisor),
            one.trial,
            one.world,
            ThinkCfg(**cfg),
            in_process,
            lambda event, **fields: told.append((event, fields)),
            limits,
        )
        questions.update_facts(one.now, believed=False)
        return one, questions, told

    return make


def test_masses_are_in_the_facts_once_something_is_believed(ask):
    one, questions, _ = ask(Careless())
    assert "mass_kg" not in questions.facts["objects"]["box"]
    questions.ask_parameters({})
    questions.update_facts(one.now)
    assert questions.facts["objects"]["box"]["mass_kg"] == round(questions.beliefs["box"].mass_kg, 5)


def leaves(value, skipped=("task", "contact_strategy", "diagnoses", "stages", "refused")):
    if isinstance(value, dict):
        return [leaf for key, item in value.items() if key not in skipped for leaf in leaves(item)]
    return [leaf for item in value for leaf in leaves(item)] if isinstance(value, list) else [value]


def shown(leaf):
    """How prompts may show a value: as it is, to the third decimal, or small ones to a few digits."""
    if isinstance(leaf, str):
        return [leaf]
    return [f"{value:.10g}" for value in (leaf, round(leaf, 3), *(float(f"{leaf:.{digits}g}") for digits in (2, 3)))]


def history(questions, **told):
    """What a question for another plan tells of the plan that failed."""
    texts = dict.fromkeys(("stage", "object", "diagnosis", "code", "explanation", "error"), "")
    lists = dict.fromkeys(("evidence", "corrected", "regions", "history", "terms"), ())
    past = {"advice": questions.advice, "earlier": [TEXTS[diagnosis] for diagnosis in questions.diagnoses[:-1]]}
    return {**texts, **lists, **past, "attempts": 3, **told}


@pytest.mark.parametrize(
    "task",
    [
        "push-force",
        "flip-wall",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("push-pick-board", "pick-clutter")),
    ],
)
def test_the_facts_hold_nothing_that_the_prompt_does_not_show(ask, task):
    advisor = Careless()
    one, questions, _ = ask(advisor, task)
    questions.ask_parameters({})
    questions.update_facts(one.now)
    questions.diagnoses.append("slipped")
    questions.diagnoses.append("blocked")
    plan = questions.ask_plan(one.now, history(questions, diagnosis=TEXTS["blocked"]))
    questions.ask_plan(one.now)
    questions.ask_regions(plan)
    for kind in ("cost-function", "cost-repair", "contact-regions"):
        question = advisor.asked(kind)
        told = [leaf for leaf in leaves(question.facts) if leaf is not None]
        assert [leaf for leaf in told if not any(text in question.prompt for text in shown(leaf))] == [], kind
    question = advisor.asked("cost-repair")
    assert all(TEXTS[diagnosis] in question.prompt for diagnosis in question.facts["diagnoses"])


FULL = {
    "attempts": 15,
    "stage": "push it past the barrier",
    "diagnosis": f"Diagnosis: {max(TEXTS.values(), key=len)}.",
    "corrected": ["mass of the thing 1.23 to 2.34 kg, friction 0.45 to 0.67."],
    "regions": ["thing, stage push: push [0.05, 0, 0.02], normal [1, 0, 0], radius 0.01"] * 2,
    "terms": [{"time_s": 12.34, "stage": "push", "terms": dict.fromkeys("abcde", 2.341)}] * 2,
    "history": [
        {
            "time_s": 14.32,
            **{name: [0.1234, -0.0567, 0.0512] for name in ("object_pos", "hand_pos", "hand_told_to")},
            **{name: [0.983, -0.012, 0.034, -0.178] for name in ("object_quat", "hand_quat")},
            "opening_told_m": 0.0423,
            "force_on_hand_n": [-3.21, 12.34, -7.65],
            "touches": ["left on thing", "right on thing", "hand on table"],
            "cost": 12.3456,
        }
    ]
    * REPAIR_ROWS,
}
"""A full history; what it is about takes a short name."""


@pytest.mark.parametrize("task", every_task())
def test_prompts_have_few_tokens(ask, task):
    """At most 3060, and 3270 in the long tasks, which state an order of events; with an arm, which takes some words.

    In these prompts a token has 3.1 characters at least, whichever tokenizer counts. Repairs with as many characters as
    here were counted one by one; the program in one is its author's, on top.
    """
    advisor = Unplanned()
    one, questions, _ = ask(advisor, task)
    name = next(iter(one.sizes))
    found = collect_evidence(steps_of(10, **{name: (0.0, 0.0, 0.03)}), (), name, np.ones(3))
    everything = dataclasses.replace(
        found, touched=0.4, others=("table",), felt=0.5, unexplained=0.2, unpredicted_n=9.0, sunk=0.1, largest_term="a"
    )
    told = {**FULL, "evidence": everything.sentences(), "object": name}
    questions.diagnoses += ["slipped", "blocked"]
    questions.ask_parameters({})
    questions.update_facts(one.now)
    questions.ask_plan(one.now)
    questions.ask_plan(one.now, history(questions, **told))
    questions.ask_everything(one.now)
    questions.ask_everything(one.now, history(questions, **{**told, "code": "x", "corrected": ()}))
    questions.ask_regions(PlanAnswer(code=UP.format(height=1)))
    first, again = [], []
    for question in advisor.questions:
        (again if "What happened lately" in question.prompt else first).append(len(question.prompt))
    assert len(again) >= 2
    more = 1.07 if task in suite_tasks("long") else 1.0
    assert max(first) / 3.1 < 3060 * more
    assert max(again) < 9880 * more


def test_what_is_advised_of_an_accepted_plan_is_told_and_shown_in_its_repair(ask):
    class Deep(Careless):
        async def answer(self, question, rejections):
            self.questions.append(question)
            below = "norm(self.ee_pos - (self.box_init_pos - np.array([0.0, 0.0, 0.06])))"
            return Reply(value=PlanAnswer(code=f"def state_cost(self):\n    return {below}"), raw="")

    advisor = Deep()
    one, questions, told = ask(advisor)
    assert questions.ask_plan(one.now) is not None
    (advice,) = dict(told)["plan_answer"]["advice"]
    assert "inside the table" in advice
    questions.ask_plan(one.now, history(questions))
    assert advice in advisor.asked("cost-repair").prompt


def test_regions_are_asked_for_the_plan_that_held_and_its_stages(ask):
    advisor = Careless(wrong=2)
    one, questions, told = ask(advisor)
    plan = questions.ask_plan(one.now)
    questions.ask_regions(plan)
    facts = advisor.asked("contact-regions").facts
    assert (facts["refused"], facts["stages"]) == (2, plan.names)
    assert len(dict(told)["plan_answer"]["refused"]) == 2


def test_without_a_plan_there_is_no_strategy(ask):
    one, questions, _ = ask(Careless(wrong=99))
    assert questions.ask_plan(one.now) is None
    with pytest.raises(NoStrategy, match="no plan"):
        questions.no_plan()


def test_a_question_about_the_plan_carries_what_went_wrong_so_far(ask):
    advisor = Careless()
    one, questions, _ = ask(advisor)
    questions.diagnoses.append("slipped")
    questions.ask_plan(one.now, history(questions, code="x = 1"))
    assert advisor.asked("cost-repair").facts["diagnoses"] == ["slipped"]
    assert "x = 1" in advisor.asked("cost-repair").prompt


def test_without_regions_nobody_is_asked_for_them(ask):
    advisor = Careless()
    one, questions, _ = ask(advisor, regions=False)
    assert questions.ask_regions(questions.ask_plan(one.now)) == RegionsAnswer({})
    assert [question.kind for question in advisor.questions] == ["cost-function"]


def test_candidates_that_cannot_be_touched_are_left_out_and_counted_in_the_record(ask):
    one, questions, told = ask(Careless())
    plan = questions.ask_plan(one.now)
    size = one.sizes["box"]
    wide = Region(
        center=(0.0, 0.0, size[2] / 2), normal=(0.0, 0.0, 1.0), extent=0.6 * float(min(size[:2])), num_samples=32
    )
    (kept,) = questions.touchable_candidates(RegionsAnswer({"box": ObjectRegions(regions=[wide])}), plan)
    (row,) = dict(told)["candidates"]["regions"]
    assert 0 < row["kept"] == len(kept) < 33
    assert row["kept"] + sum(row["lost"].values()) == 33


def test_a_refused_answer_about_everything_leaves_no_belief_behind(ask):
    class Light(Careless):
        async def answer(self, question, rejections):
            value = RULES["unified"](question.facts, ())
            light = {"box": ParameterEstimate(mass_kg=0.2, friction_coeff=0.77)}
            return Reply(value=value.model_copy(update={"parameters": light, "regions": {}}), raw="")

    one, questions, told = ask(Light(), unified=True)
    before = questions.beliefs
    assert questions.ask_everything(one.now) is None
    assert questions.beliefs == before
    assert dict(told)["beliefs"]["box"][1] != 0.77


UP = "def state_cost(self):\n    return {{'rise': abs(self.ee_pos[2] - {height})}}"


@pytest.mark.parametrize(("prompt", "shown"), [("paper", ()), ("words", ("scene",))])
def test_the_paper_s_questions_about_a_plan_come_without_a_picture(ask, prompt, shown):
    advisor = Careless()
    one, questions, _ = ask(advisor, prompt=prompt)
    questions._asker.pictures = lambda labels: (Picture(name="scene", png=b""),)
    questions.ask_parameters({})
    questions.ask_regions(questions.ask_plan(one.now) or RULES["cost-function"](questions.facts, ()))
    taken = {
        kind: [each.name for each in advisor.asked(kind).pictures] for kind in ("cost-function", "contact-regions")
    }
    assert taken == {"cost-function": list(shown), "contact-regions": list(shown)}
    assert advisor.asked("physical-parameters").pictures
    assert ("the picture shows" in advisor.asked("cost-function").prompt) == bool(shown)


class Varied:
    """The recorded model; the first answer has some parts replaced."""

    name = "varied"

    def __init__(self, **parts):
        self.parts, self.prompts, self.reasons = parts, [], []

    async def answer(self, question, rejections):
        self.prompts.append(question.prompt)
        self.reasons += [(rejection.code, rejection.reason) for rejection in rejections]
        value = RULES["unified"](question.facts, ())
        return Reply(value=value if rejections else value.model_copy(update=self.parts), raw="")


@pytest.fixture
def ask_all(scene):
    one = scene("pick-box")

    def run(advisor, wrong_plan=lambda answer: None, history=None, **cfg):
        asker = Asker(advisor)
        questions = Questions(asker, one.trial, one.world, ThinkCfg(**cfg), in_process, lambda *_, **__: None, limits)
        questions.update_facts(one.now)
        questions.check_plan = lambda plan, now: wrong_plan(plan)
        try:
            return questions.ask_everything(one.now, history)
        finally:
            asker.close()

    run.one = one
    return run


def parameters(mass, friction=0.7):
    return {"box": ParameterEstimate(mass_kg=mass, friction_coeff=friction)}


def test_its_parts_are_those_that_questions_of_their_own_would_give():
    answer = UnifiedAnswer.model_validate(
        {
            "code": CODE,
            "explanation": "Go there.",
            "parameters": {"box": {"mass_kg": 0.3, "friction_coeff": 0.5}},
            "regions": {"box": {"regions": [SIDE]}},
        }
    )
    assert answer.estimates.physical() == {"box": PhysicalParameters(mass_kg=0.3, friction=0.5)}
    assert [(name, region.center) for name, region in answer.places.each()] == [("box", (0.0, 0.0, 0.5))]
    assert type(answer.plan) is not UnifiedAnswer
    assert (answer.plan.code, answer.plan.explanation) == (CODE, "Go there.")


def test_places_may_be_left_out_and_parameters_may_not():
    assert UnifiedAnswer.model_validate({"code": CODE, "parameters": {}}).places == RegionsAnswer({})
    with pytest.raises(ValidationError, match="parameters"):
        UnifiedAnswer.model_validate({"code": CODE})


def test_what_is_accepted_is_believed(ask_all):
    advisor = Varied(parameters=parameters(0.4))
    ask_all(advisor)
    assert advisor.reasons == []
    assert ask_all.one.world.beliefs[0]["box"] == PhysicalParameters(mass_kg=0.4, friction=0.7)


def test_an_impossible_mass_is_refused_before_it_is_believed(ask_all):
    seen = []
    advisor = Varied(parameters=parameters(900.0))
    ask_all(advisor, wrong_plan=lambda answer: seen.append(ask_all.one.world.beliefs[0]["box"].mass_kg))
    assert advisor.reasons[0][0] == "bounds"
    assert len(seen) == 1
    assert seen[0] < 20.0


def test_the_plan_is_checked_with_the_beliefs_of_its_own_answer(ask_all):
    seen = []

    def wrong_plan(answer):
        seen.append(ask_all.one.world.beliefs[0]["box"].mass_kg)
        return Rejection(code="barrier", reason="dear") if len(seen) == 1 else None

    advisor = Varied(parameters=parameters(0.4))
    ask_all(advisor, wrong_plan)
    assert seen == [0.4, compose(ask_all.one.facts).parameters.root["box"].mass_kg]
    assert advisor.reasons == [("barrier", "dear")]


def test_places_are_checked_only_where_they_are_asked_for(ask_all):
    off = RegionsAnswer.model_validate({"box": {"regions": [SIDE]}}).root
    asked, unasked = Varied(regions=off), Varied(regions=off)
    ask_all(asked)
    ask_all(unasked, regions=False)
    assert asked.reasons[0][0] == "off-surface"
    assert unasked.reasons == []


def test_a_repair_shows_what_happened_and_the_first_question_does_not(ask_all):
    advisor = Varied()
    ask_all(advisor)
    nothing = dict.fromkeys(("stage", "object", "diagnosis", "explanation", "error"), "")
    none = dict.fromkeys(("evidence", "corrected", "advice", "earlier", "regions", "history", "terms"), ())
    ask_all(advisor, history={**nothing, **none, "attempts": 3, "code": "x = 1"})
    assert ["x = 1" in prompt for prompt in advisor.prompts] == [False, True]

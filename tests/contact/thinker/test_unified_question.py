import pytest
from pydantic import ValidationError
from recorded import RULES, compose

from coral.advisor.question import Rejection, Reply
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import in_process
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.questions import Questions
from coral.contact.thinker.think_cfg import ThinkCfg
from coral.contact.thinker.unified_question import UnifiedAnswer
from coral.contact.world_model.parameter_estimates import ParameterEstimate

CODE = "def state_cost(self):\n    return norm(self.ee_pos - self.box_pos)"
SIDE = {"center": (0.0, 0.0, 0.5), "normal": (0.0, 0.0, 1.0)}


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
def ask(scene):
    one = scene("pick-box")

    def run(advisor, wrong_plan=lambda answer: None, history=None, **cfg):
        asker = Asker(advisor)
        questions = Questions(asker, one.trial, one.world, ThinkCfg(**cfg), in_process, lambda *_, **__: None)
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


def test_what_is_accepted_is_believed(ask):
    advisor = Varied(parameters=parameters(0.4))
    ask(advisor)
    assert advisor.reasons == []
    assert ask.one.world.beliefs[0]["box"] == PhysicalParameters(mass_kg=0.4, friction=0.7)


def test_an_impossible_mass_is_refused_before_it_is_believed(ask):
    seen = []
    advisor = Varied(parameters=parameters(900.0))
    ask(advisor, wrong_plan=lambda answer: seen.append(ask.one.world.beliefs[0]["box"].mass_kg))
    assert advisor.reasons[0][0] == "bounds"
    assert len(seen) == 1
    assert seen[0] < 20.0


def test_the_plan_is_checked_with_the_beliefs_of_its_own_answer(ask):
    seen = []

    def wrong_plan(answer):
        seen.append(ask.one.world.beliefs[0]["box"].mass_kg)
        return Rejection(code="barrier", reason="dear") if len(seen) == 1 else None

    advisor = Varied(parameters=parameters(0.4))
    ask(advisor, wrong_plan)
    assert seen == [0.4, compose(ask.one.facts).parameters.root["box"].mass_kg]
    assert advisor.reasons == [("barrier", "dear")]


def test_places_are_checked_only_where_they_are_asked_for(ask):
    off = RegionsAnswer.model_validate({"box": {"regions": [SIDE]}}).root
    asked, unasked = Varied(regions=off), Varied(regions=off)
    ask(asked)
    ask(unasked, regions=False)
    assert asked.reasons[0][0] == "off-surface"
    assert unasked.reasons == []


def test_a_repair_shows_what_happened_and_the_first_question_does_not(ask):
    advisor = Varied()
    ask(advisor)
    nothing = dict.fromkeys(("stage", "object", "diagnosis", "explanation", "error"), "")
    none = dict.fromkeys(("evidence", "corrected", "advice", "earlier", "regions", "history", "terms"), ())
    ask(advisor, history={**nothing, **none, "attempts": 3, "code": "x = 1"})
    assert ["x = 1" in prompt for prompt in advisor.prompts] == [False, True]

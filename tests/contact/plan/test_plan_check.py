import numpy as np
import pytest

from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer
from coral.contact.plan.plan_check import judge_plan
from coral.contact.plan.sampled_states import sample_states

CODE = "def state_cost(self):\n    return norm(self.ee_pos - self.box_pos)"
GATE = """def state_cost(self):
    d = norm(self.ee_pos - self.box_pos)
    cost = 5.0 * d  # reach
    if d < 0.05:
        cost += 3.0  # close
    return cost"""


def stage(**more):
    return StageAnswer.model_validate({"name": "a", "code": CODE, **more})


@pytest.mark.parametrize(
    ("plan", "code", "words"),
    [
        (PlanAnswer(code="x = 1"), "no_return", "return"),
        (PlanAnswer(code="def state_cost(self):\n    return self.cup_pos[0]"), "unknown_state", "cup_pos"),
        (PlanAnswer(code="def state_cost(self):\n    return 1.0"), "constant", "same"),
        (PlanAnswer(stages=[stage(done="1 > 0"), stage()]), "stages", "same name"),
        (PlanAnswer(stages=[stage(), stage(name="b")]), "stages", "never ends"),
        (PlanAnswer(stages=[stage(next={"z": "1 > 0"})]), "stages", "next leads to 'z'"),
        (PlanAnswer(stages=[stage()], begin="z"), "stages", "begins with 'z'"),
        (PlanAnswer(stages=[stage(stiffness=49.0)]), "stages", "lies within 50 and 3000 N/m"),
        (PlanAnswer(stages=[stage(noise=3.1)]), "stages", "noise is 3.1; it lies within 0.05 and 3"),
        (PlanAnswer(stages=[stage(done="self.nothing > 1"), stage(name="b")]), "unknown_state", "nothing"),
    ],
)
def test_unusable_plans_are_refused_with_a_reason(scene, plan, code, words):
    one = scene("pick-box")
    found = judge_plan(plan, one.world.schema, one.samples).refusal
    assert found.code == code
    assert words in found.reason


def test_a_usable_plan_of_stages_is_accepted(scene):
    one = scene("pick-box")
    plan = PlanAnswer(stages=[stage(done="self.box_pos[2] > 0.1"), stage(name="b", next={"a": "self.time > 9"})])
    assert judge_plan(plan, one.world.schema, one.samples).refusal is None


def test_all_faults_are_told_at_once_beside_their_lines(scene):
    one = scene("pick-box")
    plan = PlanAnswer(
        stages=[
            stage(code=GATE, done="self.time > 1", stiffness=5000.0),
            stage(
                name="b",
                code="def state_cost(self):\n    x = 1.0\n    return x * self.cup_pos[0]",
                next={"c": "self.time > 9"},
            ),
        ]
    )
    found = judge_plan(plan, one.world.schema, one.samples).refusal
    assert found.details["faults"] == ["stages", "stages", "barrier", "unknown_state"]
    for words in ("it lies within 50", "next leads to 'c'", "cup_pos", "stage 'a': the cost leads"):
        assert words in found.reason
    assert "  3 |     return x * self.cup_pos[0]\n    ^ unknown_state" in found.listing


def test_an_accepted_plan_may_come_with_advice(scene):
    one = scene("flip-box")
    deep = "def state_cost(self):\n    return 5.0 * norm(self.ee_pos - (self.box_pos - np.array([0.0, 0.0, 0.095])))"
    verdict = judge_plan(PlanAnswer(code=deep), one.world.schema, one.samples)
    assert verdict.refusal is None
    (advice,) = verdict.advice
    assert "inside the table" in advice


def test_a_later_stage_is_judged_where_it_begins(scene):
    one = scene("flip-box")
    plan = PlanAnswer(stages=[stage(done="self.time > 1"), stage(name="press", code=GATE)])

    def judged(beginnings):
        return judge_plan(plan, one.world.schema, one.samples, beginnings=beginnings)

    asked = []

    def never(compiled):
        asked.append([made.answer.name for made in compiled])
        return {}

    assert judged(never).refusal is None
    assert asked == [["a", "press"]]
    assert judged(lambda compiled: {"press": one.samples}).refusal.code == "barrier"
    assert judged(None).refusal is None


def test_where_later_stages_begin_is_not_asked_without_need(scene):
    one = scene("pick-box")
    plan = PlanAnswer(stages=[stage(done="self.time > 1"), stage(name="b")])
    assert judge_plan(plan, one.world.schema, one.samples, beginnings=lambda compiled: 1 / 0).refusal is None


def test_one_plan_has_one_verdict_whenever_it_is_checked(scene):
    one = scene("push-force")
    plan = PlanAnswer(code=GATE)
    sizes = {name: np.asarray(size) for name, size in one.sizes.items()}
    first = judge_plan(plan, one.world.schema, sample_states(one.world, one.now, sizes))
    for _ in range(3):
        assert judge_plan(plan, one.world.schema, sample_states(one.world, one.now, sizes)) == first


def test_the_stage_that_a_repair_goes_on_with_is_judged_in_the_present_state(scene):
    one = scene("pick-box")
    stages = [stage(done="self.box_pos[2] > 0.1"), stage(name="b", code=GATE)]
    assert judge_plan(PlanAnswer(stages=stages), one.world.schema, one.samples).refusal is None
    found = judge_plan(PlanAnswer(stages=stages, begin="b"), one.world.schema, one.samples).refusal
    assert found.code == "barrier"

"""Plans that have been judged: most tests of the outer loop begin with the same plan in the same states."""

import pytest

from coral.contact.plan.cost_plan import in_process
from coral.contact.plan.plan_check import judge_plan

VERDICTS = {}


def values_of(sample):
    return tuple((name, sample[name].tobytes()) for name in sample.names())


def judge_once(plan, schema, samples, load, beginnings):
    """`judge_plan`, which gives the same verdict on the same programs and states."""
    if load is not in_process:
        return judge_plan(plan, schema, samples, load, beginnings)
    key = hash((plan.model_dump_json(), tuple(schema), values_of(samples)))
    if key not in VERDICTS:
        VERDICTS[key] = judge_plan(plan, schema, samples, load, beginnings)
    return VERDICTS[key]


@pytest.fixture(autouse=True)
def _judged_once(monkeypatch):
    monkeypatch.setattr("coral.contact.thinker.questions.judge_plan", judge_once)

import pytest

from coral.advisor.consult import BudgetCfg
from coral.contact.thinker.think_cfg import DESK_S, MODEL_S, NoDecision, decision_budget, stand_in


@pytest.mark.parametrize(
    ("advisor", "unset_s"), [("heuristic", MODEL_S), ("desk", DESK_S), ("sloppy:malformed=0.1:desk", DESK_S)]
)
def test_a_deadline_that_was_set_stays_though_it_is_that_of_a_model(advisor, unset_s):
    assert decision_budget(BudgetCfg(), advisor).deadline_s == unset_s
    assert decision_budget(BudgetCfg(max_requeries=1), advisor).deadline_s == unset_s
    assert decision_budget(BudgetCfg(deadline_s=MODEL_S), advisor).deadline_s == MODEL_S


def outcome(policy, by="the plan before"):
    """What is reported, and the end reason; None where the episode goes on."""
    told = []
    try:
        stand_in(lambda event, **fields: told.append((event, fields)), policy, "plan", "no-network", by)
    except NoDecision as error:
        return told, error.end_reason
    return told, None


@pytest.mark.parametrize(
    ("policy", "by", "end_reason"),
    [
        ("prior", "the plan before", None),
        ("hold", "nobody", "no-decision: plan"),
        ("fail", "nobody", "advisor failed: no-network"),
    ],
)
def test_who_stands_in_is_reported_and_without_anybody_the_episode_ends(policy, by, end_reason):
    told, ended = outcome(policy)
    assert ended == end_reason
    ((event, fields),) = told
    assert (event, fields["by"], fields["policy"], fields["because"]) == ("fallback", by, policy, "no-network")
    assert (fields["decided"], fields["source"]) == ("plan", "fallback")


def test_the_error_says_what_was_not_decided_and_why():
    assert str(NoDecision("hold", "repair", "deadline")) == (
        "the advisor did not decide on the repair (deadline), and the fallback policy 'hold' lets nothing else decide"
    )

import pytest

from coral.advisor.ledger import Ledger
from coral.advisor.model_cfg import SpendCfg
from coral.advisor.question import AdvisorUnavailable


def test_calls_are_counted_when_they_leave_and_end_at_their_bound():
    ledger = Ledger(SpendCfg(max_calls=2))
    ledger.open_call()
    ledger.open_call()
    with pytest.raises(AdvisorUnavailable, match=r"used up: 2 of 2 calls \(spend\.max_calls\)") as gone:
        ledger.open_call()
    assert (gone.value.code, gone.value.final, ledger.calls) == ("budget", True, 2)


@pytest.mark.parametrize(
    ("spend", "cost", "said"),
    [
        (SpendCfg(max_tokens=100), (60, 0.0), r"120 of 100 tokens \(spend\.max_tokens\)"),
        (SpendCfg(max_usd=0.5), (0, 0.25), r"0\.5 of 0\.5 USD \(spend\.max_usd\)"),
    ],
)
def test_tokens_and_money_end_asking_once_their_sum_reaches_the_bound(spend, cost, said):
    ledger = Ledger(spend)
    ledger.open_call()
    ledger.add(*cost)
    ledger.open_call()
    ledger.add(*cost)
    with pytest.raises(AdvisorUnavailable, match=said):
        ledger.open_call()

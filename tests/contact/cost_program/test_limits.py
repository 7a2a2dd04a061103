"""The meter stops a program that takes more than its limits, at the line where it does."""

import pytest

from coral.contact.cost.context import Context
from coral.contact.cost_program import CostError
from coral.contact.cost_program.limits import MOST_ARRAYS, MOST_STEPS, Meter


@pytest.fixture
def meter():
    return Meter(Context({}, (1, 1)))


def test_the_step_beyond_the_limit_is_refused_with_its_line(meter):
    for _ in range(MOST_STEPS):
        meter.step(5)
    with pytest.raises(CostError, match="more than 20000 steps") as caught:
        meter.step(7)
    assert (caught.value.code, caught.value.line) == ("steps", 7)


def test_the_array_beyond_the_limit_is_refused_before_it_is_made(meter):
    meter.made(MOST_ARRAYS - 2)
    meter.made(2)
    with pytest.raises(CostError, match="more than 4000 arrays") as caught:
        meter.made()
    assert caught.value.code == "memory"


@pytest.mark.parametrize(
    ("start", "turn"),
    [
        ("np.ones(1000)", "w = v * 1.0"),
        ("np.ones(1000)", "w = v[1:]"),
        ("[x for x in np.ones(1000)]", "w = np.array(v)"),
        ("[x for x in np.ones(1000)]", "w = v + [1.0]"),
        ("[x for x in np.ones(1000)]", "w = max(v)"),
        ("{'a': [x for x in np.ones(1000)]}", "v['b'] = 1.0"),
    ],
)
def test_arithmetic_of_constants_counts_too(start, turn, refusal):
    body = f"v = {start}\nfor i in range(64):\n    for j in range(64):\n        {turn}\nreturn self.time"
    assert refusal(body).code == "steps"

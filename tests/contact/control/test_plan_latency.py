import pytest

from coral.contact.control.plan_latency import PlanLatency
from coral.errors import InputError


def test_a_fixed_latency_passes_in_whole_control_steps_whatever_the_machine():
    latency = PlanLatency("fixed:0.11", 0.02, 2, 50)
    assert latency.charged
    assert latency.expected_steps() == latency.taken_steps(9.0) == 6
    assert PlanLatency("fixed:0.01", 0.02, 2, 50).expected_steps() == 2  # no sooner than plans are asked for


def test_without_latency_nothing_is_charged():
    assert not PlanLatency("0", 0.02, 2, 50).charged
    assert not PlanLatency("fixed:0", 0.02, 2, 50).charged


def test_a_measured_latency_is_expected_from_the_plans_before():
    latency = PlanLatency("measured", 0.02, 2, 50)
    assert latency.charged
    assert latency.expected_steps() == 2
    assert [latency.taken_steps(seconds) for seconds in (0.1, 0.1, 0.5)] == [5, 5, 25]
    assert latency.expected_steps() == 6  # a tenth above the median
    assert latency.taken_steps(60.0) == 49  # something of the plan is left


@pytest.mark.parametrize("spec", ["soon", "fixed", "fixed:", "0.1", "fixed:-1", "fixed:nan", "fixed:1.0", "measured:1"])
def test_other_texts_and_latencies_as_long_as_a_plan_are_refused(spec):
    with pytest.raises(InputError, match=r"planning\.latency"):
        PlanLatency(spec, 0.02, 2, 50)

"""Costs under several beliefs."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.mppi.risk import RiskCfg, risk

COSTS = np.array([[1.0, 8.0], [2.0, 2.0], [3.0, 5.0], [10.0, 1.0]])


@pytest.mark.parametrize(
    ("cfg", "expected"),
    [
        (RiskCfg(measure="mean"), [4.0, 4.0]),
        (RiskCfg(measure="worst"), [10.0, 8.0]),
        (RiskCfg(measure="cvar", share=0.5), [6.5, 6.5]),
        (RiskCfg(measure="cvar", share=0.25), [10.0, 8.0]),
        (RiskCfg(measure="cvar", share=0.0), [10.0, 8.0]),
        (RiskCfg(measure="cvar", share=1.0), [4.0, 4.0]),
        (RiskCfg(measure="cvar", share=0.3), [6.5, 6.5]),
    ],
)
def test_four_beliefs(cfg, expected):
    assert risk(COSTS, cfg) == pytest.approx(expected)


@pytest.mark.parametrize("measure", ["mean", "worst", "cvar"])
def test_one_belief_is_itself(measure):
    assert risk(COSTS[:1], RiskCfg(measure=measure)) == pytest.approx(COSTS[0])


@pytest.mark.parametrize("measure", ["mean", "worst", "cvar"])
def test_diverging_under_one_belief_rules_a_sequence_out(measure):
    costs = COSTS.copy()
    costs[1, 0] = np.inf
    found = risk(costs, RiskCfg(measure=measure))
    assert np.isinf(found[0])
    assert np.isfinite(found[1])


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=8), st.floats(0, 1))
def test_cvar_lies_between_mean_and_worst(values, share):
    costs = np.array(values)[:, None]
    found = risk(costs, RiskCfg(measure="cvar", share=share))[0]
    assert costs.mean() - 1e-6 <= found <= costs.max() + 1e-6

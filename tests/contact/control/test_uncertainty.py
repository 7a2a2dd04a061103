import numpy as np
import pytest

from coral.contact.control.uncertainty import UncertaintyCfg, sample_beliefs
from coral.contact.scene.trial import PhysicalParameters

BELIEF = {"box": PhysicalParameters(0.5, 0.4), "tin": PhysicalParameters(0.1, 0.8)}


def test_one_set_is_the_belief_alone():
    assert sample_beliefs(BELIEF, UncertaintyCfg(), np.random.default_rng(0)) == [BELIEF]


def test_others_scatter_about_the_belief_as_far_as_asked():
    trial = sample_beliefs(BELIEF, UncertaintyCfg(sets=4001, mass=0.3, friction=0.2), np.random.default_rng(0))
    assert trial[0] == BELIEF
    masses = np.log([one["box"].mass_kg for one in trial[1:]])
    frictions = np.log([one["tin"].friction for one in trial[1:]])
    assert masses.mean() == pytest.approx(np.log(0.5), abs=0.02)
    assert masses.std() == pytest.approx(0.3, abs=0.02)
    assert frictions.std() == pytest.approx(0.2, abs=0.02)


def test_the_same_seed_draws_the_same_beliefs():
    cfg = UncertaintyCfg(sets=3)
    assert sample_beliefs(BELIEF, cfg, np.random.default_rng(2)) == sample_beliefs(
        BELIEF, cfg, np.random.default_rng(2)
    )

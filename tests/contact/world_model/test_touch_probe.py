import numpy as np
import pytest

from coral.contact.scene.trial import PhysicalParameters, sample_trial
from coral.contact.tasks import load_task
from coral.contact.world_model.identification import IdentifyCfg
from coral.contact.world_model.touch_probe import ProbeCfg, probe

TRUTH, FIRST = PhysicalParameters(0.1, 0.5), PhysicalParameters(2.0, 0.9)


def test_a_belief_far_off_is_corrected_by_what_was_felt_and_seen():
    trial = sample_trial(load_task("push-pick-board"), 0)
    cfg = ProbeCfg(corrections=1, windows=4, replay_dt_s=0.004, identify=IdentifyCfg(grid=4, samples=10, rounds=1))
    (fit,) = probe(trial, "board", TRUTH, FIRST, cfg, np.random.default_rng(0))
    assert fit.before == FIRST
    assert fit.accepted
    assert fit.error_after < 0.5 * fit.error_before
    # The product is what a push shows; a coarse fit of one round must come near it.
    assert fit.after.mass_kg * fit.after.friction == pytest.approx(0.05, rel=0.6)
    assert "board: mass 2 to" in fit.words()

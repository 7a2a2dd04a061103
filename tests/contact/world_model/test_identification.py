import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from histories import history

from coral.contact.scene.trial import PhysicalParameters
from coral.contact.world_model import identification as module
from coral.contact.world_model.force_balance import Balance
from coral.contact.world_model.history_replay import HistoryReplay
from coral.contact.world_model.identification import (
    fit_by_balance,
    fit_by_replay,
    replay_errors,
)

TRUTH, FIRST = PhysicalParameters(0.1, 0.5), PhysicalParameters(2.0, 0.9)


def replayed(*errors):
    """Make a replay with these errors of a belief and a proposal."""
    parts = np.array(errors)[:, None]
    return SimpleNamespace(windows=[None] * 3, parts=lambda *_: parts, score=lambda found, _: found)


def test_a_proposal_equal_to_the_belief_explains_no_better(scene):
    one = scene("pick-box")
    steps = [dataclasses.replace(step, before=one.now, after=one.now) for step in history(6, box=(0.0, 0.0, 0.03))]
    before, after = replay_errors(HistoryReplay(one.world, [steps]), "box", one.beliefs, one.beliefs)
    assert before == after


def test_what_a_history_does_not_tell_stays_as_it_was_believed(scene, monkeypatch):
    # Slow pushes: the product of mass and friction is known to 10 %, neither of them is.
    before = {"box": PhysicalParameters(1.0, 0.5)}
    monkeypatch.setattr(module, "identify", lambda *_: (PhysicalParameters(4.0, 0.2), (5.0, 5.0, 0.1)))
    fit = fit_by_replay(replayed(1.0, 0.4), "box", before, np.random.default_rng(0))
    assert fit.after.mass_kg * fit.after.friction == pytest.approx(0.8, rel=0.05)
    assert fit.after.mass_kg == pytest.approx(1.5, rel=0.2)
    assert fit.accepted


def test_what_forces_propose_is_believed_where_replay_and_forces_explain_more():
    held = np.tile([0.981, 9.81], (40, 1))
    dragged = np.tile([0.5 * (0.981 + 4.0), 4.0, 0.0], (40, 1))
    before = {"board": FIRST}
    # The replay alone would rather have it a little otherwise: a rolled-out pinch slips.
    replay = replayed(0.8, 1.1)
    fit = fit_by_balance(Balance(dragged, held), replay, "board", before)
    assert fit.accepted
    assert fit.after.mass_kg == pytest.approx(0.1, rel=0.05)
    assert fit.after.friction == pytest.approx(0.5, rel=0.05)
    assert not fit_by_balance(Balance(dragged, held), replay, "board", {"board": fit.after}).accepted


def test_without_balances_the_replay_alone_decides():
    assert replay_errors(replayed(0.8, 1.1), "board", {"board": FIRST}, {"board": TRUTH}) == (0.8, 1.1)

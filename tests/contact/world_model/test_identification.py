import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from coral.contact.control.planning_world import PlanningCfg, PlanningWorld
from coral.contact.control.rollouts import SLEEP
from coral.contact.rules.adjustments import adjustment_after
from coral.contact.scene.observation import HandTarget, Transition
from coral.contact.scene.trial import PhysicalParameters, sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.diagnosis import diagnose, recent
from coral.contact.world_model import identification as module
from coral.contact.world_model.force_balance import Balance
from coral.contact.world_model.history import Window, most_informative_object, windows
from coral.contact.world_model.history_replay import HistoryReplay
from coral.contact.world_model.identification import (
    Corrections,
    Fit,
    IdentifyCfg,
    compare,
    fit_by_balance,
    fit_by_replay,
    replay_errors,
)
from coral.contact.world_model.touch_probe import ProbeCfg, probe

TRUTH, FIRST = PhysicalParameters(0.1, 0.5), PhysicalParameters(2.0, 0.9)


def test_a_belief_far_off_is_corrected_by_what_was_felt_and_seen():
    trial = sample_trial(load_task("push-pick-board"), 0)
    cfg = ProbeCfg(corrections=1, windows=4, replay_dt_s=0.004, identify=IdentifyCfg(grid=4, samples=10, rounds=1))
    fit = next(iter(probe(trial, "board", TRUTH, FIRST, cfg, np.random.default_rng(0))))
    assert fit.accepted
    assert fit.error_after < 0.5 * fit.error_before
    # The product is what a push shows; a coarse fit of one round must come near it.
    assert fit.after.mass_kg * fit.after.friction == pytest.approx(0.05, rel=0.6)
    assert "board: mass 2 to" in fit.words()


def still(scene, force=0.0):
    one = scene("pick-box")
    felt = type(one.now)(
        one.now.time_s, one.now.tool, one.now.opening_m, np.array([force, 0, 0, 0, 0, 0]), one.now.objects
    )
    return one, Transition(one.now, HandTarget(one.now.tool.position, one.now.tool.quaternion, 0.08, 600.0), felt)


def test_a_history_without_touch_says_nothing(scene):
    _, step = still(scene)
    assert most_informative_object([step] * 30) is None
    assert windows([step] * 30, "box") == []
    assert most_informative_object([]) is None


def test_a_proposal_equal_to_the_belief_explains_no_better(scene):
    trial = sample_trial(load_task("pick-box"), 0)
    one, step = still(scene)
    world = PlanningWorld(trial, one.beliefs, one.now, PlanningCfg(threads=1))
    replay = HistoryReplay(world, [Window((step,) * 6)])
    before, after = compare(replay, "box", one.beliefs, one.beliefs)
    assert before == after
    world.close()
    assert Corrections().fits == []


def test_nothing_sleeps_in_a_replay(scene):
    one = scene("pick-clutter")
    step = Transition(one.now, HandTarget(one.now.tool.position, one.now.tool.quaternion, 0.08, 600.0), one.now)
    assert all(model.opt.enableflags & SLEEP == SLEEP for model in one.world.models)
    HistoryReplay(one.world, [Window((step,) * 3)]).parts([one.beliefs], "can")
    assert not any(model.opt.enableflags & SLEEP for model in one.world.models)


def test_a_window_that_diverges_under_every_belief_decides_nothing():
    replay = HistoryReplay(SimpleNamespace(edges=False), [], None)
    parts = np.array([[[1.0, 2.0], [np.inf, np.inf]], [[3.0, 2.0], [np.inf, np.inf]]])
    score = replay.score(parts, parts.min(axis=0))
    assert np.isfinite(score).all()
    assert score[0, 1] == score[1, 1]
    assert score[0, 0] < score[1, 0]


def test_rows_for_prompts_carry_the_cost_of_their_own_plan_and_what_was_told(scene):
    one, step = still(scene)
    steps = [
        dataclasses.replace(
            step,
            before=dataclasses.replace(step.before, time_s=0.1 * k),
            after=dataclasses.replace(step.after, time_s=0.1 * (k + 1)),
        )
        for k in range(5)
    ]
    rows = recent(steps, [(0.0, 9.0), (0.2, 7.0), (0.4, 5.0)], "box")
    assert [row["cost"] for row in rows] == [9.0, 9.0, 7.0, 7.0, 5.0]
    assert rows[0]["opening_told_m"] == 0.08
    assert rows[0]["hand_told_to"] == [round(float(v), 4) for v in one.now.tool.position]


@pytest.mark.parametrize(
    ("force", "returns", "surprise", "kind"),
    [
        (0.0, 0, 0.0, "not-reached"),
        (3.0, 0, 0.0, "not-moved"),
        (3.0, 3, 0.0, "slipped"),
        (3.0, 0, 0.1, "moved-otherwise"),
    ],
)
def test_diagnoses(scene, force, returns, surprise, kind):
    _, step = still(scene, force)
    assert diagnose([step] * 10, "box", returns, surprise) == kind
    assert adjustment_after([kind]) != adjustment_after([])


def over_time(step, places):
    """One step for each place of the hand, 0.1 s apart; it is told to be where it is."""
    steps = []
    for k, place in enumerate(places):
        tool = dataclasses.replace(step.after.tool, position=step.after.tool.position + place)
        after = dataclasses.replace(step.after, time_s=0.1 * (k + 1), tool=tool)
        before = dataclasses.replace(step.before, time_s=0.1 * k)
        command = dataclasses.replace(step.command, position=tool.position)
        steps.append(dataclasses.replace(step, before=before, after=after, command=command))
    return steps


def test_a_hand_that_stays_where_it_was_told_to_be_tells_of_a_wrong_cost_and_one_that_is_held_up_does_not(scene):
    _, step = still(scene, 0.0)
    steps = over_time(step, np.zeros((30, 3)))
    assert diagnose(steps, "box", 0, 0.1) == "settled"
    assert adjustment_after(["settled"]) != adjustment_after([])
    higher = dataclasses.replace(step.command, position=step.command.position + np.array([0.0, 0.0, 0.03]))
    assert diagnose([dataclasses.replace(one, command=higher) for one in steps], "box", 0, 0.1) == "moved-otherwise"
    assert diagnose(steps[:10], "box", 0, 0.0) == "not-reached"


def test_a_hand_that_wanders_about_a_place_stays_and_one_that_goes_on_does_not(scene):
    _, step = still(scene, 0.0)
    wandering = 0.012 * np.random.default_rng(4).standard_normal((40, 3))
    assert diagnose(over_time(step, wandering), "box", 0, 0.1) == "settled"
    going_on = np.outer(np.arange(40), [0.002, 0.0, 0.0])  # 2 cm/s
    assert diagnose(over_time(step, going_on), "box", 0, 0.1) == "moved-otherwise"


def test_a_hand_that_presses_hard_against_what_lies_still_is_blocked_and_one_that_moves_it_is_not(scene):
    _, step = still(scene, 35.0)
    ahead = dataclasses.replace(step.command, position=step.command.position + np.array([0.05, 0.0, 0.0]))
    steps = [dataclasses.replace(one, command=ahead) for one in over_time(step, np.zeros((40, 3)))]
    assert diagnose(steps, "box", 0, 0.1) == "blocked"
    assert adjustment_after(["blocked"]) == adjustment_after(["settled"])  # another side, not a harder push

    def pushed(one, k):
        box = one.after.objects["box"]
        moved = dataclasses.replace(box, position=box.position + np.array([0.001 * k, 0.0, 0.0]))
        return dataclasses.replace(one, after=dataclasses.replace(one.after, objects={"box": moved}))

    assert diagnose([pushed(one, k) for k, one in enumerate(steps)], "box", 0, 0.1) == "moved-otherwise"
    assert diagnose(over_time(still(scene, 3.0)[1], np.zeros((15, 3))), "box", 0, 0.0) == "not-moved"


def test_what_a_history_does_not_tell_stays_as_it_was_believed(scene, monkeypatch):
    # Slow pushes: the product of mass and friction is known to 10 %, neither of them is.
    before, after = {"box": PhysicalParameters(1.0, 0.5)}, PhysicalParameters(4.0, 0.2)
    found = Fit("box", before["box"], after, 1.0, 0.5, True, 5.0, 5.0, 0.1, 8)
    monkeypatch.setattr(module, "identify", lambda *_: found)
    monkeypatch.setattr(module, "compare", lambda *_: (1.0, 0.4))
    fit = fit_by_replay(None, "box", before, IdentifyCfg(), np.random.default_rng(0))
    assert fit.after.mass_kg * fit.after.friction == pytest.approx(0.8, rel=0.05)
    assert fit.after.mass_kg == pytest.approx(1.5, rel=0.2)
    assert fit.accepted


def test_what_forces_propose_is_believed_where_replay_and_forces_explain_more(monkeypatch):
    held = np.tile([0.981, 9.81], (40, 1))
    dragged = np.tile([0.5 * (0.981 + 4.0), 4.0, 0.0], (40, 1))
    before = {"board": FIRST}
    replay = SimpleNamespace(windows=[None] * 3)
    # The replay alone would rather have it a little otherwise: a rehearsed pinch slips.
    monkeypatch.setattr(module, "compare", lambda *_: (0.8, 1.1))
    fit = fit_by_balance(Balance(dragged, held), replay, "board", before, IdentifyCfg())
    assert fit.accepted
    assert fit.after.mass_kg == pytest.approx(0.1, rel=0.05)
    assert fit.after.friction == pytest.approx(0.5, rel=0.05)
    assert not fit_by_balance(Balance(dragged, held), replay, "board", {"board": fit.after}, IdentifyCfg()).accepted


def test_without_balances_the_replay_alone_decides(monkeypatch):
    monkeypatch.setattr(module, "compare", lambda *_: (0.8, 1.1))
    assert replay_errors(None, "board", {"board": FIRST}, {"board": TRUTH}, IdentifyCfg()) == (0.8, 1.1)

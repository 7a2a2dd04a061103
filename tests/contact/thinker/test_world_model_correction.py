"""Which corrections are believed. The fit has tests of its own; here its result and the replay's errors are given."""

import dataclasses
import itertools
import json

import numpy as np
import pytest
from histories import history, sliding
from recorded import RULES

from coral.advisor.question import Reply
from coral.contact.scene.observation import HandTarget, Transition
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.thinker import world_model_correction
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.think_cfg import ThinkCfg
from coral.contact.thinker.world_model_correction import CorrectionSchedule, correct_beliefs
from coral.contact.world_model.corrected_parameters import ObjectParameters, ParametersAnswer
from coral.contact.world_model.identification import Fit

FITTED = PhysicalParameters(0.4, 0.3)
MOVED = history(100, period_s=0.1, box=sliding(1.0))
"""Ten seconds in which the box slides."""


class Scripted:
    """Gives these masses one after the other, or what the default advisor says where there are none."""

    name = "scripted"

    def __init__(self, masses=(), friction=0.3):
        self.masses, self.friction, self.questions, self.reasons = list(masses), friction, [], []

    async def answer(self, question, rejections):
        self.questions.append(question)
        self.reasons += [rejection.reason for rejection in rejections[-1:]]
        if not self.masses:
            return Reply(value=RULES[question.kind](question.facts, rejections), raw="")
        one = ObjectParameters(label="box", mass=self.masses.pop(0), friction=self.friction)
        return Reply(value=ParametersAnswer(objects=[one]), raw="")


def pushed(one, steps=40, sunk_m=0.0):
    """A history in which the box moves 2 mm with each step."""
    box, target = one.now.objects["box"], HandTarget(one.now.tool.position, one.now.tool.quaternion, 0.08, 600.0)
    seen = [
        dataclasses.replace(
            one.now,
            time_s=0.02 * k,
            objects={"box": dataclasses.replace(box, position=box.position + np.array([0.002 * k, 0.0, -sunk_m]))},
        )
        for k in range(steps + 1)
    ]
    return tuple(Transition(before, target, after) for before, after in itertools.pairwise(seen))


@pytest.fixture
def correct(scene, monkeypatch):
    """Corrects what is believed of the box, with a replay whose error is the distance from the fitted mass."""
    one, told = scene("pick-box"), []

    def run(advisor, steps, better=True):
        believed = one.world.beliefs[0]["box"]

        def errors(replay, name, beliefs, proposed, found):
            return tuple(abs(held[name].mass_kg - FITTED.mass_kg) for held in (beliefs, proposed))

        fit = Fit("box", believed, FITTED if better else believed, 1.0, 0.1, better, 0.1, 0.1, 0.1, 3)
        monkeypatch.setattr(world_model_correction, "fit_by_replay", lambda *_: fit)
        monkeypatch.setattr(world_model_correction, "replay_errors", errors)
        done = correct_beliefs(
            Asker(advisor),
            "box",
            one.now,
            steps,
            [],
            one.trial,
            one.world,
            one.facts,
            ThinkCfg(),
            np.random.default_rng(0),
            lambda event, **fields: told.append((event, fields)),
        )
        return done, believed, one.world.beliefs[0]["box"], told

    run.one = one
    return run


def test_what_explains_the_history_better_is_believed_and_reported(correct):
    advisor = Scripted()
    done, before, after, told = correct(advisor, pushed(correct.one))
    assert done
    assert after == FITTED != before
    (question,) = advisor.questions
    assert question.facts["fitted"] == {"object": "box", "mass_kg": 0.4, "friction": 0.3, "better": True}
    ((event, fields),) = told
    assert (event, fields["accepted"]) == ("correction", True)
    assert fields["before"] == [before.mass_kg, before.friction]
    assert fields["after"] == [0.4, 0.3]
    assert fields["errors"] == [round(abs(before.mass_kg - 0.4), 4), 0.0]
    assert json.dumps(fields)


def test_what_explains_it_no_better_is_refused_with_both_errors(correct):
    before = correct.one.world.beliefs[0]["box"].mass_kg
    advisor = Scripted([before, 0.41])
    done, _, after, told = correct(advisor, pushed(correct.one))
    assert done
    assert after.mass_kg == 0.41
    error = f"{abs(before - 0.4):.2f}"
    assert f"error {error}, now {error}" in advisor.reasons[0]
    assert told[0][1]["refused"] == advisor.reasons


def test_values_that_are_kept_are_accepted_without_a_replay_and_correct_nothing(correct):
    before = correct.one.world.beliefs[0]["box"]
    advisor = Scripted([before.mass_kg], friction=before.friction)
    done, _, after, told = correct(advisor, pushed(correct.one))
    assert (done, after) == (False, before)
    assert advisor.reasons == []
    ((_, fields),) = told
    assert (fields["accepted"], fields["failure"], fields["text"]) == (False, "", "the values were kept")


def test_the_question_shows_the_expected_motion_beside_the_measured_one(correct):
    advisor = Scripted()
    correct(advisor, pushed(correct.one))
    (question,) = advisor.questions
    header = "from_s | to_s | expected_moved_mm | measured_moved_mm | expected_turned_deg | measured_turned_deg | "
    _, _, rows = question.prompt.partition(f"{header}expected_force_n | measured_force_n\n")
    first = rows.split("\n")[0].split(" | ")
    assert first[2] == "0 0 0"
    assert first[3] in ("22 0 0", "24 0 0")


def test_values_out_of_bounds_are_refused_before_anything_is_replayed(correct):
    advisor = Scripted([300.0, 0.4])
    assert correct(advisor, pushed(correct.one))[0]
    assert "300" in advisor.reasons[0]


def test_where_no_answer_holds_the_beliefs_stay(correct):
    done, before, after, told = correct(Scripted([300.0] * 9), pushed(correct.one))
    assert not done
    assert after == before
    assert not told[0][1]["accepted"]


def test_the_default_advisor_corrects_nothing_that_its_fit_did_not_better(correct):
    done, before, after, told = correct(Scripted(), pushed(correct.one), better=False)
    assert (done, after) == (False, before)
    assert told[0][1]["failure"] == "no-better-fit"


@pytest.mark.parametrize(("steps", "sunk_m"), [(0, 0.0), (13, 0.0), (40, 0.02)])
def test_little_touch_or_an_object_seen_inside_the_table_leaves_nothing_to_replay(correct, steps, sunk_m):
    advisor = Scripted([0.4])
    done, before, after, told = correct(advisor, pushed(correct.one, steps, sunk_m))
    assert (done, after, advisor.questions) == (False, before, [])
    assert "too little" in told[0][1]["text"]


def due_times(schedule, steps):
    """Simulated times at which a correction is due, asked after every step."""
    return [round(steps[k - 1].after.time_s, 6) for k in range(1, len(steps) + 1) if schedule.due(steps[:k])]


def test_a_correction_is_due_at_each_interval_until_all_but_the_last_are_spent():
    assert due_times(CorrectionSchedule(every_s=1.0), MOVED) == [1.0, 2.0, 3.0, 4.0]


def test_the_last_one_is_kept_for_the_end_of_the_episode():
    schedule = CorrectionSchedule(every_s=1.0)
    due_times(schedule, MOVED[:50])
    assert schedule.due(MOVED, last=True) == "box"
    assert schedule.done == 5
    assert schedule.due(MOVED, last=True) is None


def test_at_the_end_no_interval_is_waited_for():
    assert CorrectionSchedule(every_s=60.0).due(MOVED, last=True) == "box"


def test_without_an_interval_or_a_history_nothing_is_due():
    assert CorrectionSchedule(every_s=0.0).due(MOVED, last=True) is None
    assert CorrectionSchedule(every_s=2.0).due([], last=True) is None


def test_an_interval_without_touch_is_not_counted_and_the_next_touch_is_corrected_at_once():
    def later(k):
        return (0.001 * max(0, k - 52), 0.0, 0.03)

    schedule = CorrectionSchedule(every_s=2.0)
    # 4 mm have been gone at step 56
    assert due_times(schedule, history(60, period_s=0.1, box=later)) == [5.6]
    assert schedule.done == 1


def test_each_correction_is_of_what_was_moved_since_the_one_before():
    def box(k):
        return (0.002 * min(k, 20), 0.0, 0.03)

    def cup(k):
        return (0.5, 0.001 * max(0, k - 20), 0.03)

    schedule = CorrectionSchedule(every_s=2.0)
    steps = history(40, period_s=0.1, box=box, cup=cup)
    assert [schedule.due(steps[:k]) for k in (20, 40)] == ["box", "cup"]

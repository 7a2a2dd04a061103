from dataclasses import replace

import numpy as np
import pytest
from histories import TOOL, history, sliding

from coral.contact.plan.stage_end import EndPart, PartReading
from coral.contact.thinker.diagnosis import TEXTS, diagnose
from coral.contact.thinker.evidence import collect_evidence
from coral.contact.thinker.progress_monitor import PlanNote

BOX = (0.1, 0.0, 0.03)
AHEAD = (0.0, 0.0, 0.33)


def moving(k):
    """A hand that never rests."""
    return (0.0, 0.0, 0.3 - 0.001 * k)


def moving_aside(k):
    """A hand that never rests, at the height of the object."""
    return (-0.2 + 0.0005 * k, 0.0, 0.03)


def felt(newtons, steps=10, box=BOX, returns=0, surprise_m=0.0, **more):
    """What is found of a force on the hand, which is the object's and as predicted."""
    force = (newtons, 0.0, 0.0)
    steps = history(steps, box=box, force=force, **more)
    notes = [replace(note, expected_force=force) for note in plans(steps, *(["box"] if newtons else []))]
    return judged(steps, notes, returns, surprise_m)


def judged(steps, notes, returns=0, surprise_m=0.0):
    return diagnose(steps, "box", returns, surprise_m, collect_evidence(steps, notes, "box", np.full(3, 0.06)))


def plans(steps, *touched):
    return [PlanNote(step.after.time_s, "reach", {}, {"hand": touched}) for step in steps[::4]]


@pytest.mark.parametrize(
    ("newtons", "more", "kind"),
    [
        (0.0, {}, "not-reached"),
        (0.4, {}, "not-reached"),
        (3.0, {}, "not-moved"),
        (3.0, {"box": sliding(1.0)}, "no-progress"),
        (0.8, {}, "no-progress"),
        (3.0, {"surprise_m": 0.1}, "moved-otherwise"),
        (0.0, {"surprise_m": 0.1}, "moved-otherwise"),
        (3.0, {"returns": 1}, "not-moved"),
        (3.0, {"returns": 2, "surprise_m": 0.1}, "slipped"),
    ],
)
def test_a_failure_is_told_by_what_was_felt_and_what_moved(newtons, more, kind):
    assert felt(newtons, **more) == kind
    assert kind in TEXTS


def test_without_a_history_there_is_no_progress():
    assert diagnose([], "box", 0, 0.1, None) == "no-progress"
    assert diagnose([], "box", 2, 0.1, None) == "slipped"


def test_a_hand_at_rest_where_it_was_told_to_be_tells_of_a_wrong_cost():
    assert felt(0.0, steps=100) == "settled"
    assert felt(0.0, steps=100, surprise_m=0.1) == "settled"
    assert felt(0.0, steps=10) == "not-reached"


def test_a_hand_that_wanders_about_a_place_is_settled_and_one_that_goes_on_is_not():
    wander = 0.012 * np.random.default_rng(4).standard_normal((200, 3))

    def wandering(k):
        return tuple(np.array([0.0, 0.0, 0.3]) + wander[k])

    def going_on(k):
        return (0.0008 * k, 0.0, 0.3)

    assert felt(0.0, steps=100, tool=wandering, told=lambda k: wandering(k + 1), surprise_m=0.1) == "settled"
    assert felt(0.0, steps=100, tool=going_on, told=lambda k: going_on(k + 1), surprise_m=0.1) == "moved-otherwise"


def test_a_hand_that_is_held_up_is_not_settled():
    assert felt(3.0, steps=100, told=AHEAD) == "not-moved"


def test_a_hand_or_an_object_on_its_way_is_not_settled():
    assert felt(0.0, steps=100, tool=moving) == "not-reached"
    assert felt(3.0, steps=100, box=sliding(0.4)) == "no-progress"


def test_what_came_to_rest_two_seconds_ago_is_settled():
    def box(k):
        return (0.001 * min(k, 60), 0.0, 0.03)

    assert felt(0.0, steps=170, box=box) == "settled"
    assert felt(0.0, steps=100, box=box) == "not-reached"


def test_a_hand_that_presses_hard_against_what_lies_still_is_blocked_and_one_that_moves_it_is_not():
    assert felt(35.0, steps=110, told=AHEAD, surprise_m=0.1) == "blocked"
    assert felt(35.0, steps=110, told=AHEAD, surprise_m=0.1, box=sliding(1.0)) == "moved-otherwise"
    assert felt(3.0, steps=110, told=AHEAD) == "not-moved"
    assert felt(35.0, steps=20, told=AHEAD) == "not-moved"


def test_a_hand_that_went_away_untouched_is_told_of_a_wrong_sign():
    away = history(
        100, box=BOX, tool=lambda k: (0.0, 0.0, 0.2 + 0.002 * k), told=lambda k: (0.0, 0.0, 0.23 + 0.002 * k)
    )
    assert judged(away, plans(away)) == "led-away"
    nearer = history(
        100, box=BOX, tool=lambda k: (0.0, 0.0, 0.4 - 0.002 * k), told=lambda k: (0.0, 0.0, 0.37 - 0.002 * k)
    )
    assert judged(nearer, plans(nearer)) == "not-reached"


def test_a_hand_that_stands_behind_its_commands_and_feels_nothing_is_out_of_reach():
    behind = history(110, box=BOX, told=(0.0, 0.0, 0.35))
    assert judged(behind, plans(behind)) == "out-of-reach"
    assert judged(behind[:40], plans(behind[:40])) == "not-reached"


def test_forces_where_nothing_is_believed_to_be_tell_of_a_wrong_pose():
    steps = history(110, box=BOX, force=(5.0, 0.0, 0.0), told=AHEAD)
    assert judged(steps, plans(steps)) == "pose-wrong"
    assert judged(steps, plans(steps, "table", "box")) == "not-moved"


def test_a_force_that_no_rollout_predicts_tells_of_a_wrong_pose_and_a_harder_push_does_not():
    steps = history(110, box=BOX, force=(0.0, 0.0, 15.0), told=AHEAD)

    def predicted(newtons, *at_last):
        notes = [*plans(steps[:80], "box"), *plans(steps[80:], *at_last)]
        return [replace(note, expected_force=(0.0, 0.0, newtons)) for note in notes]

    assert judged(steps, predicted(0.0)) == "pose-wrong"
    assert judged(steps, predicted(0.0, "box")) == "not-moved"  # what is held all the time is heavier than believed
    assert judged(steps, predicted(15.0)) == "not-moved"
    assert judged(steps, predicted(4.5)) == "not-moved"  # what is pushed is heavier than believed


def test_fingers_inside_an_object_tell_of_a_wrong_pose_though_the_grasp_slipped():
    steps = history(110, box=BOX)
    sunk = [replace(note, sunk_m={"box": 0.02 * (k < 3)}) for k, note in enumerate(plans(steps))]
    assert judged(steps, sunk, returns=2) == "pose-wrong"
    shallow = [replace(note, sunk_m={"box": 0.004}) for note in plans(steps)]
    assert judged(steps, shallow, returns=2) == "slipped"


def test_a_hand_at_the_edge_is_led_away_by_a_reward_and_out_of_reach_by_a_cost():
    steps = history(110, box=BOX)

    def at_edge(value):
        return [replace(note, at_edge=1.0, terms={"way": value, "small": 0.1}) for note in plans(steps)]

    assert judged(steps, at_edge(-9.0)) == "led-away"
    assert judged(steps, at_edge(3.0)) == "out-of-reach"
    held = [replace(note, touched={"left": ("box",)}) for note in at_edge(3.0)]
    assert judged(steps, held) == "settled"


def test_a_hand_at_rest_that_presses_on_what_does_not_move_is_not_settled():
    steps = history(110, box=BOX, force=(3.0, 0.0, 0.0))
    assert judged(steps, plans(steps, "box")) == "not-moved"
    assert judged(steps, plans(steps, "table")) == "settled"


def test_commands_that_wander_about_a_hand_at_rest_lead_it_nowhere():
    steps = history(110, box=BOX, told=lambda k: (0.03 * (-1) ** k, 0.0, 0.3))
    assert judged(steps, plans(steps)) == "settled"


NEAR = EndPart("norm(self.off) < 0.012", "<", "m", "norm(self.off)", "0.012")
TOUCH = EndPart("self.box_left_contact", "holds", "truth", "self.box_left_contact", "0.5")


def ending(steps, *parts, terms=None):
    """Notes about plans of a stage whose end has these parts: comparison, left and right side.

    When the stage began, the left side was ten times as large.
    """
    end = tuple(PartReading(*one) for one in parts)
    far = tuple(PartReading(part, 10.0 * left, right) for part, left, right in parts)
    return [replace(note, end=end if k else far, terms=terms or {}) for k, note in enumerate(plans(steps))]


def test_a_hand_at_rest_just_short_of_the_stages_end_tells_of_a_wrong_end_and_farther_off_of_a_wrong_cost():
    steps = history(110, box=BOX)
    assert judged(steps, ending(steps, (NEAR, 0.02, 0.012))) == "stage-never-ends"
    assert judged(steps, ending(steps, (NEAR, 0.05, 0.012))) == "settled"
    assert judged(steps, ending(steps, (NEAR, 0.02, 0.012), (TOUCH, 0.0, 0.5))) == "settled"


def test_a_stage_that_waits_only_for_a_contact_never_ends_and_one_that_is_not_there_yet_has_a_wrong_cost():
    steps = history(110, box=BOX)
    assert judged(steps, ending(steps, (NEAR, 0.01, 0.012), (TOUCH, 0.0, 0.5))) == "stage-never-ends"
    assert judged(steps, ending(steps, (TOUCH, 0.0, 0.5))) == "settled"


def test_an_end_from_which_the_cost_leads_away_to_the_object_is_wrong():
    beside = (0.0, 0.0, 0.27)
    steps = history(110, box=beside)
    began = {"reach": (PartReading(NEAR, 0.1, 0.012),)}

    def told(terms, box=beside):
        steps = history(110, box=box)
        notes = ending(steps, (NEAR, 0.4, 0.012), terms=terms)
        found = collect_evidence(steps, notes, "box", np.full(3, 0.06), began)
        return diagnose(steps, "box", 0, 0.0, found)

    assert told({"way": 0.1}) == "stage-never-ends"
    assert told({"way": -9.0}) == "settled"  # a reward may have led there
    assert told({"way": 0.1}, box=BOX) == "settled"
    assert judged(steps, ending(steps, (NEAR, 0.4, 0.012))) == "settled"


def test_an_object_at_rest_under_the_hand_has_arrived_if_the_end_is_near():
    steps = history(110, box=BOX, force=(3.0, 0.0, 0.0))
    pressed = [replace(note, touched={"left": ("box",)}) for note in ending(steps, (NEAR, 0.02, 0.012))]
    assert judged(steps, pressed) == "stage-never-ends"
    held_up = history(110, box=BOX, force=(0.0, 0.0, 30.0), told=AHEAD)  # it presses the object on what it lies on
    pressed = [replace(note, touched={"left": ("box",)}) for note in ending(held_up, (NEAR, 0.02, 0.012))]
    assert judged(held_up, pressed) == "stage-never-ends"
    going = history(110, box=BOX, tool=moving)
    assert judged(going, ending(going, (NEAR, 0.02, 0.012))) == "not-reached"
    far = [replace(note, touched={"left": ("box",)}) for note in ending(steps, (NEAR, 0.2, 0.012))]
    assert judged(steps, far) == "not-moved"


def test_open_fingers_round_the_object_that_were_never_told_to_close_have_not_gripped_it():
    around = history(110, box=TOOL, force=(0.0, 0.0, 30.0), told=AHEAD)
    assert judged(around, plans(around, "box")) == "not-gripped"
    waiting, other = ending(around, (TOUCH, 0.0, 0.5)), ending(around, (NEAR, 0.5, 0.012))
    assert judged(around, [replace(note, touched={"hand": ("box",)}) for note in waiting]) == "not-gripped"
    assert judged(around, [replace(note, touched={"hand": ("box",)}) for note in other]) == "blocked"
    assert judged(around, plans(around, "box"), returns=2) == "slipped"
    closing = [replace(step, command=replace(step.command, opening_m=0.0)) for step in around]
    assert judged(closing, plans(closing, "box")) == "blocked"
    beside = history(110, box=BOX, force=(0.0, 0.0, 30.0), told=AHEAD)
    assert judged(beside, plans(beside, "box")) == "blocked"


def test_a_hand_that_presses_hard_and_stands_is_blocked_though_the_object_slips_away_under_it():
    slips = history(110, box=sliding(0.15), force=(0.0, 0.0, 35.0), told=AHEAD)
    assert judged(slips, plans(slips, "box")) == "blocked"
    goes_on = history(
        110,
        box=sliding(0.4),
        force=(0.0, 0.0, 35.0),
        tool=lambda k: (0.0004 * k, 0.0, 0.3),
        told=lambda k: (0.0004 * k, 0.0, 0.33),
    )
    assert judged(goes_on, plans(goes_on, "box")) == "no-progress"


def test_a_hand_that_stands_on_the_table_has_not_reached_the_object():
    """The planner keeps it from pressing hard there; too little force on the object is not what is wrong."""
    steps = history(110, box=BOX, force=(0.0, 0.0, 8.0), told=AHEAD)
    assert judged(steps, plans(steps, "table")) == "not-reached"
    assert judged(steps, plans(steps, "table", "box")) == "not-moved"


def test_a_hand_that_brushed_the_object_on_its_way_has_not_reached_it():
    brushed = history(150, box=BOX, tool=moving_aside, force=lambda k: (20.0 if k == 5 else 0.0, 0.0, 0.0))
    notes = plans(brushed)
    assert judged(brushed, [replace(notes[0], touched={"left": ("box",)}), *notes[1:]]) == "not-reached"
    assert judged(brushed, [replace(note, touched={"left": ("box",)}) for note in notes]) == "no-progress"


def test_no_diagnosis_claims_an_obstacle_that_was_not_felt():
    assert "in its way" not in TEXTS["not-reached"]


@pytest.mark.parametrize(
    ("height_m", "box", "kind"),
    [
        (0.09, BOX, "passes-over"),
        (0.03, BOX, "no-progress"),
        (0.09, sliding(1.0), "no-progress"),
    ],
)
def test_a_hand_that_passes_over_the_object_is_too_high(height_m, box, kind):
    over = history(100, box=box, tool=lambda k: (0.05 + 0.002 * k, 0.0, height_m), force=(0.8, 0.0, 0.0))
    assert judged(over, plans(over, "box")) == kind

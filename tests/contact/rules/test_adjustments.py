from dataclasses import replace

import pytest

from coral.contact.rules.adjustments import adjustment_after, change_words
from coral.contact.rules.scene_reading import SkillAdjustment
from coral.contact.thinker.diagnosis import TEXTS

AS_IS = SkillAdjustment()


@pytest.mark.parametrize("diagnosis", TEXTS)
def test_every_diagnosis_changes_something(diagnosis):
    assert adjustment_after([diagnosis]) != adjustment_after([]) == AS_IS


def test_a_slip_is_answered_by_a_harder_and_lower_grasp_and_a_missed_object_by_another_side():
    slipped = adjustment_after(["slipped"])
    assert (slipped.press, slipped.lower_m, slipped.careful, slipped.turn) == (1.4, 0.006, 0.8, 0)
    assert adjustment_after(["not-reached"]) == SkillAdjustment(turn=1)
    assert adjustment_after(["not-moved"]) == SkillAdjustment(press=1.6)
    assert adjustment_after(["moved-otherwise"]) == SkillAdjustment(careful=0.8)


def test_a_stage_that_never_ends_is_answered_by_a_looser_end_once_and_then_by_another_side():
    assert adjustment_after(["stage-never-ends"]) == SkillAdjustment(loose=1.5)
    assert adjustment_after(["stage-never-ends"] * 2) == SkillAdjustment(loose=1.5, turn=1)
    assert change_words(AS_IS, SkillAdjustment(loose=1.5)) == (
        "The new one goes on from 1.5 times as far from where the hand reaches"
    )


def test_failures_add_up_in_their_order():
    found = adjustment_after(["not-reached", "slipped", "not-reached"])
    assert (found.turn, found.press) == (2, 1.4)


def test_however_often_it_slips_the_hand_stays_within_what_is_safe():
    found = adjustment_after(["slipped"] * 20)
    assert (found.press, found.lower_m, found.careful) == (3.0, 0.012, 0.5)


def test_a_repair_is_described_by_what_it_changed():
    before = SkillAdjustment(press=1.5, lower_m=0.002)
    after = replace(before, press=3.0, lower_m=0.008, careful=0.8)
    assert change_words(before, after) == (
        "The new one presses and squeezes 2.0 times as hard and takes hold 6 mm lower and moves more carefully in "
        "contact"
    )
    assert change_words(before, replace(before, turn=1)) == "The new one takes the next grasp or side that fits"


def test_a_repair_that_changes_nothing_says_so():
    assert change_words(AS_IS, AS_IS) == "The new one tries the same again"

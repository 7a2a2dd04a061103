from dataclasses import replace

import numpy as np
import pytest
from histories import history, sliding

from coral.contact.plan.stage_end import EndPart, PartReading
from coral.contact.thinker.evidence import collect_evidence
from coral.contact.thinker.progress_monitor import PlanNote

SIZE = np.array([0.06, 0.06, 0.06])
BOX = (0.0, 0.0, 0.03)


def note(time_s, *touched, terms=None):
    return PlanNote(time_s, "push", terms or {}, {"left": touched, "right": (), "hand": ()})


def evidence(steps, notes=()):
    return collect_evidence(steps, notes, "box", SIZE)


def coming_down(k):
    return (0.0, 0.0, 0.26 - 0.001 * k)


def test_distances_are_measured_to_the_objects_box():
    found = evidence(history(100, box=BOX, tool=coming_down, told=lambda k: np.array(coming_down(k)) - [0, 0, 0.004]))
    assert (found.first_m, found.least_m, found.last_m) == pytest.approx((0.2, 0.1, 0.1))
    assert found.lag_m == pytest.approx(0.003)
    assert (found.seconds, found.moved_m) == pytest.approx((2.0, 0.0))
    assert "no nearer than 10.0 cm to the box" in found.sentences()[0]


def test_touches_of_the_object_and_of_others_are_shares_of_the_plans():
    notes = [note(0.5, "box"), note(1.0, "box", "table"), note(1.5), note(2.0)]
    found = evidence(history(100, box=sliding(0.5), force=(3.0, 0.0, 0.0)), notes)
    assert (found.touched, found.others, found.moved_m) == (0.5, ("table",), pytest.approx(0.05))
    told = " ".join(found.sentences())
    assert "touched the box for 50 % of the last 2.0 s" in told
    assert "It also touched: table." in told


def test_a_force_with_nothing_near_is_unexplained():
    pushed = history(100, box=BOX, force=lambda k: (3.0 if k > 50 else 0.0, 0.0, 0.0))
    found = evidence(pushed, [note(0.4), note(1.4, "box"), note(1.8)])
    assert (found.felt, found.unexplained) == (pytest.approx(2 / 3), 0.5)
    assert (found.force_peak_n, evidence(pushed).felt) == (3.0, 0.0)


def test_fingers_inside_the_object_and_targets_at_the_edge_are_told():
    notes = [replace(note(0.02 * k, terms={"way": -3.0}), sunk_m={"box": 0.008 * (k % 2)}) for k in range(100)]
    at_edge = [replace(each, at_edge=0.9) for each in notes]
    found = evidence(history(100, box=BOX), at_edge)
    assert (found.sunk, found.largest_value, found.at_edge) == (0.5, -3.0, pytest.approx(0.9))
    told = " ".join(found.sentences())
    assert "For 50 % of the time the hand was inside the box by the believed poses." in told
    assert "At the end its targets stood at the edge of its workspace." in told
    assert "edge" not in " ".join(evidence(history(100, box=BOX), notes).sentences())


def test_open_fingers_round_the_object_and_closing_are_told():
    steps = history(200, box=BOX, tool=BOX)
    found = evidence(steps)
    assert (found.around, found.closing) == (1.0, 0.0)
    told = "At the end the box was between the fingers, which were told to close on something for 0 % of the time."
    assert told in found.sentences()
    closing = [replace(step, command=replace(step.command, opening_m=0.07)) for step in steps[:50]] + steps[50:]
    assert evidence(closing).closing == 0.25
    narrow = [replace(step, after=replace(step.after, opening_m=0.05)) for step in steps]
    assert evidence(narrow).around == 0.0  # fingers beside each other on top of it are not round it
    assert evidence(history(200, box=BOX, tool=lambda k: (0.0, 0.0, 0.03 + 0.04 * (k > 50)))).around == 0.0


def test_the_end_of_the_stage_is_told():
    near = EndPart("norm(self.off) < 0.012", "<", "m", "norm(self.off)", "0.012")
    notes = [replace(note(0.02 * k), end=(PartReading(near, 0.02 if k else 0.2, 0.012),)) for k in range(100)]
    found = evidence(history(100, box=BOX), notes)
    assert found.end.misses_by_little
    assert found.sentences()[-1] == "Stage 'push' ends when `norm(self.off) < 0.012`: 0.02 m at best, 0.02 m now."


def test_a_hand_that_presses_hard_is_a_little_inside_what_it_presses_on():
    notes = [replace(note(0.02 * k, "box"), sunk_m={"box": 0.010}) for k in range(100)]
    assert evidence(history(100, box=BOX), notes).sunk == 1.0
    assert evidence(history(100, box=BOX, force=(0.0, 0.0, 30.0)), notes).sunk == 0.0


def test_felt_and_predicted_forces_are_compared_as_vectors():
    pushed = history(100, box=BOX, force=(0.0, 0.0, 9.0))
    notes = [
        replace(note(0.4, "box"), expected_force=(3.0, 0.0, 9.0)),
        replace(note(1.4), expected_force=(3.0, 0, 1.0)),
    ]
    found = evidence(pushed, notes)
    assert (found.predicted_n, found.unpredicted_n) == pytest.approx((np.hypot(3.0, 5.0), np.hypot(3.0, 4.0)))
    assert "differed from the predicted one by 5.0 N" in " ".join(found.sentences())


def test_the_largest_term_of_the_last_plan_is_named():
    found = evidence(history(10, box=BOX), [note(0.1, terms={"a": 9.0}), note(0.2, terms={"a": 1.0, "b": -3.0})])
    assert (found.largest_term, found.largest_share) == ("b", 0.75)
    assert "'b' makes up 75 % of the cost" in found.sentences()[-1]


def test_a_hand_that_passes_over_the_object_is_told_with_its_height():
    over = history(200, box=BOX, tool=lambda k: (-0.1 + 0.001 * k, 0.0, 0.08))
    found = evidence(over)
    assert (found.above_m, found.over) == pytest.approx((0.02, 0.3), abs=0.01)
    assert (found.passed_m, found.crossed) == pytest.approx((0.06, 1.0), abs=0.02)
    assert any("2.0 cm or more above its top" in sentence for sentence in found.sentences())
    beside = evidence(history(200, box=BOX, tool=lambda k: (-0.1 + 0.001 * k, 0.0, 0.03)))
    assert (beside.over, beside.crossed) == (0.0, 0.0)
    coming = evidence(history(100, box=BOX, tool=coming_down))
    assert (coming.over, coming.crossed) == (1.0, 0.0)

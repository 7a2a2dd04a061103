from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from coral.contact.thinker.plan_note import FORCE_STEPS, note_of
from coral.contact.thinker.strategist import PlanReport


def test_a_note_keeps_what_a_diagnosis_reads_and_averages_the_first_predicted_forces():
    force = np.zeros((2 * FORCE_STEPS, 3))
    force[:FORCE_STEPS, 2] = np.linspace(0.0, 4.0, FORCE_STEPS)
    plan = SimpleNamespace(terms={"way": 3.0}, expected_force=force, at_edge=0.5)
    touched, sunk_m = {"left": ("box",)}, {"box": 0.01}
    note = note_of(PlanReport(SimpleNamespace(time_s=0.3), plan, "reach", touched=touched, sunk_m=sunk_m))
    assert (note.time_s, note.stage, note.terms, note.touched) == (0.3, "reach", {"way": 3.0}, touched)
    assert note.end == ()
    assert (note.expected_force, note.sunk_m, note.at_edge) == ((0.0, 0.0, 2.0), sunk_m, 0.5)


def test_a_note_keeps_how_the_end_of_the_stage_stands_in_the_measured_state():
    plan = SimpleNamespace(terms={}, expected_force=np.zeros((2, 3)), at_edge=0.0)
    end = SimpleNamespace(read=lambda present: (present,))
    report = PlanReport(SimpleNamespace(time_s=0.3), plan, "reach", present="measured")
    assert note_of(report, end).end == ("measured",)
    assert note_of(report).end == note_of(replace(report, present=None), end).end == ()

from types import SimpleNamespace

import numpy as np

from coral.contact.cost.context import Context
from coral.contact.plan.imagined_run import ImaginedMoment
from coral.contact.plan.plan_rehearsal import summarize_rehearsal, unreached_stages
from coral.contact.scene.observation import BodyState, Observation

UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def moment(k, stage, following, *, x=0.0, force=0.0, touch=0.0, terms=None):
    now = Observation(
        3.0 + 0.1 * k,
        BodyState(np.array([x, 0.0, 0.2]), UPRIGHT),
        0.04,
        np.array([force, 0.0, 0.0, 0.0, 0.0, 0.0]),
        {"box": BodyState(np.array([x, 0.0, 0.03]), UPRIGHT)},
    )
    contacts = Context({f"box_{part}_contact": np.full((1, 1), touch) for part in ("hand", "left", "right")}, (1, 1))
    plan = SimpleNamespace(now=contacts, terms=terms or {"cost": 1.0})
    return ImaginedMoment(now, stage, following, plan)


RUN = [
    moment(0, "reach", "reach"),
    moment(1, "reach", "push", x=0.01),
    moment(2, "push", "push", x=0.01, force=4.0, touch=1.0),
    moment(3, "push", "push", x=0.05, force=8.0, touch=1.0, terms={"a": -9.0, "b": 1.0, "c": 2, "d": 3, "e": 4}),
]


def test_each_stage_has_a_row_with_what_happened_in_it():
    reach, push = summarize_rehearsal(RUN)
    assert (reach["stage"], reach["began_s"], reach["ended_s"], reach["then"]) == ("reach", 0.0, 0.1, "push")
    assert reach["objects"]["box"] == {"moved_mm": [10.0, 0.0, 0.0], "turned_deg": 0.0, "touched_s": 0.0}
    assert (push["began_s"], push["ended_s"], push["then"]) == (0.2, None, "")
    assert push["objects"]["box"] == {"moved_mm": [40.0, 0.0, 0.0], "turned_deg": 0.0, "touched_s": 0.2}
    assert (push["force_mean_n"], push["force_peak_n"]) == (6.0, 8.0)
    assert push["terms"] == {"a": -9.0, "e": 4.0, "d": 3.0, "c": 2.0}


def test_a_stage_to_which_the_plan_falls_back_appears_again():
    rows = summarize_rehearsal([moment(0, "grip", "lift"), moment(1, "lift", "grip"), moment(2, "grip", "grip")])
    assert [row["stage"] for row in rows] == ["grip", "lift", "grip"]


def test_stages_that_were_not_reached_are_named():
    assert unreached_stages(summarize_rehearsal(RUN), ["reach", "push", "retreat"]) == ["retreat"]
    assert summarize_rehearsal([]) == []

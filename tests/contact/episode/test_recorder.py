import numpy as np

from coral.contact.episode.recorder import ContactLog, columns
from coral.contact.scene.observation import BodyState, Contact, Truth

BODY = BodyState(np.zeros(3), np.array([1.0, 0, 0, 0]))


def truth(t, *contacts):
    return Truth(t, BODY, 0.08, {}, contacts)


def touch(newtons):
    return Contact("box", "left", np.array([newtons, 0.0, 0.0]), np.array([0.0, 0.0, 0.1]))


def test_a_contact_is_told_once_with_force_and_point_and_once_with_mean_and_peak():
    watched = ContactLog(gap_s=0.05)
    ((t, event, fields),) = watched.update(truth(0.02, touch(2.0)))
    assert (t, event) == (0.02, "contact")
    assert fields == {"first": "box", "second": "left", "force_n": 2.0, "point": [0.0, 0.0, 0.1]}
    assert watched.update(truth(0.04, touch(4.0))) == []
    assert watched.update(truth(0.08)) == []
    ((t, event, fields),) = watched.update(truth(0.10))
    assert (t, event) == (0.10, "contact_end")
    assert fields == {"first": "box", "second": "left", "begun_s": 0.02, "ended_s": 0.04, "peak_n": 4.0, "mean_n": 3.0}


def test_a_contact_that_flickers_is_one():
    watched = ContactLog(gap_s=0.1)
    seen = [truth(0.02 * k, *([touch(1.0)] if k % 3 == 0 else [])) for k in range(20)]
    events = [event for moment in seen for event in watched.update(moment)]
    assert [name for _, name, _ in events] == ["contact"]
    assert [fields["ended_s"] for _, _, fields in watched.finish()] == [0.36]
    assert watched.finish() == []


def test_columns_name_every_object_and_are_told_apart():
    names = columns(["box", "can"])
    assert len(set(names)) == len(names)
    assert {"box_hand_force", "can_touch_z", "cmd_opening", "stage"} <= set(names)

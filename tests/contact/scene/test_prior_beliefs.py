import dataclasses

import pytest
from contact_bench import make_trial

from coral.contact.scene.prior_beliefs import FRICTION, prior_beliefs, stated_beliefs


def test_what_is_only_seen_is_taken_for_the_same_stuff_whatever_the_task_states():
    trial = make_trial()
    held = prior_beliefs(trial)["box"]
    assert (held.mass_kg, held.friction) == (pytest.approx(500.0 * 0.06**3), FRICTION)
    (box,) = trial.task.objects
    other = trial.task.model_copy(update={"objects": (box.model_copy(update={"mass_kg": (3.0, 5.0)}),)})
    heavier = dataclasses.replace(trial, task=other)
    assert prior_beliefs(heavier)["box"] == held
    assert stated_beliefs(heavier)["box"].mass_kg == 4.0

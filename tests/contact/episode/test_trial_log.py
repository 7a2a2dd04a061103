"""What every episode records of its trial, and why it ends."""

import json

import numpy as np
import pytest
import yaml
from contact_bench import body, make_trial, touch, truth

from coral.contact.episode.trial_log import conditions_not_held, end_reason, parameter_fields, start_fields, write_head
from coral.contact.scene.judge import Judge
from coral.contact.scene.task import Task
from coral.contact.scene.trial import PhysicalParameters
from coral.runs import RunWriter


def test_the_task_that_is_written_can_be_read_again(tmp_path):
    trial = make_trial()
    writer = RunWriter(tmp_path / "run", ("t",))
    write_head(writer, trial, {"world": "hand", "seed": 7}, {"replan_steps": 2})
    writer.close()
    assert Task.model_validate(yaml.safe_load((tmp_path / "run" / "task.yaml").read_text())) == trial.task
    config = yaml.safe_load((tmp_path / "run" / "config.yaml").read_text())
    assert (config["system"], config["task"], config["world"], config["seed"]) == ("contact", "bench", "hand", 7)
    assert config["episode"] == {"replan_steps": 2}
    assert "provenance" in config


def test_the_start_tells_what_is_asked_and_what_is_true(tmp_path):
    trial = make_trial(objects=[make_trial().task.objects[0].model_dump() | {"mass_kg": (0.1, 0.9)}], seed=3)
    fields = json.loads(json.dumps(start_fields(trial, advisor="none")))
    assert (fields["task"], fields["instruction"], fields["time_limit_s"]) == ("bench", "Do it.", 10)
    assert fields["advisor"] == "none"
    assert fields["trial"]["box"] == {
        "mass_kg": pytest.approx(trial.objects["box"].physical.mass_kg, abs=1e-5),
        "friction": 0.5,
        "size_m": [0.06, 0.06, 0.06],
    }
    assert fields["trial"]["box"]["mass_kg"] not in (0.1, 0.9)


def test_parameters_are_rounded_for_the_log():
    assert parameter_fields(PhysicalParameters(0.1234567, 0.56789)) == {"mass_kg": 0.12346, "friction": 0.5679}


def test_an_episode_goes_on_until_success_failure_or_its_limit():
    judge = Judge(make_trial({"kind": "released"}))
    held = touch("box", "hand")
    assert end_reason(judge, truth(0.0, body(), held), True) == ""
    assert end_reason(judge, truth(0.02), True) == ""  # released, but not for long enough
    assert end_reason(judge, truth(0.12), True) == "success"
    assert end_reason(judge, truth(0.14, body(), held), False) == "timeout"


def test_success_at_the_last_moment_counts_and_a_lost_object_counts_more():
    judge = Judge(make_trial({"kind": "released"}))
    end_reason(judge, truth(0.0), True)
    assert end_reason(judge, truth(0.2), False) == "success"
    assert end_reason(judge, truth(0.2, body(np.array([0.5, 0.0, -0.2]))), True) == "dropped: box"


def test_an_episode_ends_with_a_condition_that_is_broken_for_good():
    judge = Judge(make_trial({"kind": "never-touched", "thing": "hand"}, {"kind": "released"}))
    assert end_reason(judge, truth(0.0), True) == ""
    assert end_reason(judge, truth(0.02, body(), touch("box", "hand")), True) == "broken: never-touched of box"


def test_a_timeout_tells_which_conditions_do_not_hold():
    trial = make_trial()
    kinds = [one.kind for one in trial.task.success.conditions]
    holding = [True] * len(kinds)
    now = truth(0.0)
    assert conditions_not_held(trial, holding, now) == ""
    holding[0] = False
    assert conditions_not_held(trial, holding, now).startswith(f"not held: box {kinds[0]}")
    assert conditions_not_held(trial, (), now) == ""  # nothing was checked
    resting = make_trial({"kind": "resting", "thing": "table"})
    assert conditions_not_held(resting, [False], now) == "not held: box resting on table"

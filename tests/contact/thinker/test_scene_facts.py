import dataclasses
import json

import numpy as np
import pytest
from contact_bench import body, make_trial, plain, seen

from coral.contact.scene.trial import PhysicalParameters, sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.world_model.parameter_estimates import belief_prompt

BOX = plain()["objects"][0]


def box_facts(beliefs=None, **changes):
    trial = make_trial(objects=[BOX | changes])
    return scene_facts(trial, seen(trial), beliefs)["objects"]["box"]


def test_facts_do_not_hold_the_true_parameters():
    trial = sample_trial(load_task("pick-clutter"), 3)
    facts = scene_facts(trial, seen(trial))
    text = json.dumps(facts) + json.dumps(belief_prompt(facts))
    for item in trial.objects.values():
        assert not any(
            f"{value:.{digits}f}" in text
            for digits in (3, 4, 5)
            for value in (item.physical.mass_kg, item.physical.friction)
        )


def test_poses_are_those_that_are_seen_and_not_the_true_ones():
    trial = make_trial()
    facts = scene_facts(trial, seen(trial, box=body((0.1, 0.2, 0.03), (0, 0, 180))))
    assert facts["objects"]["box"]["pose"] == pytest.approx([0.1, 0.2, 0.03, 0.0, 0.0, 0.0, 1.0])
    assert facts["hand"]["pose"][:3] == [-0.1, 0.0, 0.25]


def test_masses_and_frictions_are_those_that_are_believed():
    assert "mass_kg" not in box_facts()
    believed = box_facts({"box": PhysicalParameters(mass_kg=1.234567, friction=0.98765)})
    assert (believed["mass_kg"], believed["friction"]) == (1.23457, 0.9877)


def test_sizes_points_and_parts_are_scaled_as_the_object_is():
    found = box_facts(scale=[1, 2, 1])
    assert found["size_m"] == [0.06, 0.12, 0.06]
    assert found["points"] == {"corner": [0.03, 0.06, 0.03]}
    assert found["parts"] == [{"size_m": [0.06, 0.12, 0.06], "position": [0.0, 0.0, 0.0]}]


def test_a_part_that_is_turned_is_left_out_and_the_box_that_holds_it_is_not():
    parts = [{"size": [0.06, 0.04, 0.02]}, {"size": [0.1, 0.02, 0.02], "rpy_deg": [0, 0, 90]}]
    found = box_facts(parts=parts)
    assert [part["size_m"] for part in found["parts"]] == [[0.06, 0.04, 0.02]]
    assert found["size_m"] == [0.06, 0.1, 0.02]


def test_the_solid_share_is_the_volume_of_the_parts_in_the_box_that_holds_them():
    assert box_facts()["solid_share"] == 1.0
    assert box_facts(parts=[{"shape": "cylinder", "size": [0.06, 0.06, 0.1]}])["solid_share"] == 0.785
    apart = [{"size": [0.02, 0.02, 0.02], "position": [x, 0, 0]} for x in (-0.04, 0.04)]
    assert box_facts(parts=apart)["solid_share"] == 0.4


def test_the_middle_of_the_box_is_said_where_it_is_not_the_origin():
    assert "middle_m" not in box_facts()
    aside = box_facts(parts=[{"size": [0.06, 0.06, 0.06], "position": [0, 0.05, 0]}])
    assert aside["middle_m"] == [0.0, 0.05, 0.0]


def test_an_object_without_a_label_is_called_by_its_name():
    assert box_facts()["label"] == "box"
    assert box_facts(label="upright box")["label"] == "upright box"


def test_the_table_reaches_half_its_size_from_its_centre():
    trial = make_trial(table={"center": [0.1, -0.2], "size": [1.0, 0.8, 0.05]})
    table = scene_facts(trial, seen(trial))["table"]
    assert (table["x"], table["y"]) == (pytest.approx([-0.4, 0.6]), pytest.approx([-0.6, 0.2]))


def test_another_truth_makes_no_other_facts():
    trial = make_trial()
    box = dataclasses.replace(
        trial.objects["box"], physical=PhysicalParameters(9.0, 1.9), pose=body(np.array([0.3, 0.3, 0.3]))
    )
    assert scene_facts(dataclasses.replace(trial, objects={"box": box}), seen(trial)) == scene_facts(trial, seen(trial))


def test_a_joint_is_told_with_where_it_stands():
    hinge = {"kind": "hinge", "axis": [0, 0, 1], "point": [-0.03, 0, 0], "range": [0, 90], "start": 30}
    found = box_facts(joint=hinge)["joint"]
    assert found.pop("now") == pytest.approx(30)
    assert found == {"kind": "hinge", "axis": [0, 0, 1], "point": [-0.03, 0, 0], "range": [0, 90], "friction": 0.02}
    assert "joint" not in box_facts()


def test_fingers_pressed_together_are_not_open_by_less_than_nothing():
    trial = make_trial()
    pressed = dataclasses.replace(seen(trial), opening_m=-0.011)
    assert scene_facts(trial, pressed)["hand"]["opening_m"] == 0.0

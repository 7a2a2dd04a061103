import math
from dataclasses import replace

import numpy as np
import pytest

from coral.contact.scene.trial import PhysicalParameters, sample_trial
from coral.contact.tasks import load_task
from coral.exam.contact_scenes import (
    MATERIALS,
    STATED_FRICTION,
    STATED_KG,
    looks_like,
    made_of,
    trial_from_json,
    trial_to_json,
)

BY_LABEL = {material.label: material for material in MATERIALS}


def material_of(trial, name):
    return BY_LABEL[trial.task.object(name).label.removesuffix(f" {name}")]


@pytest.mark.parametrize("task", ["pick-box", "pick-clutter", "push-pick-board"])
def test_objects_weigh_what_their_material_does(task):
    shares = {"box": 1.0, "cylinder": math.pi / 4, "sphere": math.pi / 6}
    for seed in range(4):
        trial = made_of(load_task(task), seed)
        for name, item in trial.objects.items():
            parts = trial.task.object(name).parts
            volume = sum(shares[part.shape] * np.prod(part.size) for part in parts) * np.prod(item.scale)
            expected = material_of(trial, name).density_kg_m3 * volume
            assert item.physical.mass_kg == pytest.approx(np.clip(expected, *STATED_KG), rel=0.5)
            assert item.physical.friction == pytest.approx(material_of(trial, name).friction, rel=0.5)


def test_labels_name_the_material_and_what_the_task_states_tells_nothing():
    items = [item for seed in range(6) for item in made_of(load_task("pick-clutter"), seed).task.objects]
    assert len({item.label.removesuffix(f" {item.name}") for item in items}) > 4
    assert {item.mass_kg for item in items} == {STATED_KG}
    assert {item.friction for item in items} == {STATED_FRICTION}


def test_the_same_seed_makes_the_same_scene():
    task = load_task("pick-clutter")
    assert trial_to_json(made_of(task, 3)) == trial_to_json(made_of(task, 3)) != trial_to_json(made_of(task, 4))


def test_a_plain_box_stands_either_way_round_so_that_no_face_is_always_the_right_one():
    task = load_task("pick-box")
    usual = [sample_trial(made_of(task, seed).task, seed).objects["box"].pose for seed in range(12)]
    stands = [made_of(task, seed).objects["box"].pose for seed in range(12)]
    along = [abs(float(a.quaternion @ b.quaternion)) for a, b in zip(usual, stands, strict=True)]
    assert {round(value) for value in along} == {0, 1}
    for a, b in zip(usual, stands, strict=True):
        np.testing.assert_array_equal(a.position, b.position)


def test_a_box_is_seen_as_one_whatever_its_task_says():
    trial = sample_trial(load_task("pick-clutter"), 0)
    assert looks_like(trial, "can") == trial.task.object("can").symmetry != "box"
    plain = trial.task.object("block").model_copy(update={"symmetry": "none"})
    task = trial.task.model_copy(
        update={"objects": tuple(plain if item.name == "block" else item for item in trial.task.objects)}
    )
    assert looks_like(replace(trial, task=task), "block") == "box"


def test_a_trial_comes_back_from_json():
    trial = made_of(load_task("pick-clutter"), 7)
    again = trial_from_json(trial_to_json(trial))
    assert (again.task, again.seed) == (trial.task, trial.seed)
    for name, item in trial.objects.items():
        other = again.objects[name]
        assert other.physical == item.physical == PhysicalParameters(item.physical.mass_kg, item.physical.friction)
        np.testing.assert_array_equal(other.scale, item.scale)
        np.testing.assert_array_equal(other.pose.position, item.pose.position)
        np.testing.assert_array_equal(other.pose.quaternion, item.pose.quaternion)


def test_a_joint_comes_back_from_json_where_it_stood():
    """At 0, an open drawer counted as shut, and a plan that did nothing as a success."""
    trial = sample_trial(load_task("close-drawer"), 0)
    again = trial_from_json(trial_to_json(trial))
    pose = trial.objects["drawer"].pose
    assert again.joint_position("drawer", pose) == trial.joint_position("drawer", pose) > 0.07
    assert "joint_start" not in trial_to_json(sample_trial(load_task("pick-box"), 0))["objects"]["box"]

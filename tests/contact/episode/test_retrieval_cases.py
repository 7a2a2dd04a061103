"""The test set of the memory's retrieval."""

import pytest

from coral.contact.episode.retrieval_cases import NOTHING, REMEMBERED, change_task, load_retrieval_cases
from coral.contact.scene.task_file import load_task_file, shipped_tasks, unseen_tasks
from coral.contact.scene.trial import sample_trial
from coral.errors import InputError


def test_the_shipped_tasks_and_unseen_ones_for_development_are_remembered():
    assert set(shipped_tasks()) < set(REMEMBERED) < {*shipped_tasks(), *unseen_tasks("development")}


@pytest.mark.parametrize("half", ["development", "test"])
def test_every_case_is_a_task_that_can_be_tried(half):
    cases = load_retrieval_cases(half)
    assert {one.change for one in cases} == {"words", "size", "height", "extra", "several", "other"}
    for one in cases:
        sample_trial(one.task, 0)
        assert set(one.fits) <= {*REMEMBERED, NOTHING}
        assert (NOTHING in one.fits) == (one.change == "other")


def test_the_halves_share_no_changed_task():
    first, second = ({one.task.model_dump_json() for one in load_retrieval_cases(h)} for h in ("development", "test"))
    assert not first & second


def test_a_change_renames_drops_adds_sets_and_says():
    changed = change_task(
        load_task_file("pick-box"),
        {
            "rename": {"box": "crate"},
            "drop": ["still"],
            "add": {"fixtures": [{"name": "shelf", "size": [0.1, 0.1, 0.1], "position": [0.3, 0.3, 0.05]}]},
            "set": {"objects.crate.parts.0.size": [0.05, 0.05, 0.1], "success.conditions.lifted.height_m": 0.05},
            "say": "Take it.",
        },
        "here",
    )
    assert (changed.objects[0].name, changed.objects[0].parts[0].size) == ("crate", (0.05, 0.05, 0.1))
    assert [one.kind for one in changed.success.conditions] == ["lifted", "upright", "grasped"]
    assert {one.object for one in changed.success.conditions} == {"crate"}
    assert changed.success.conditions[0].height_m == 0.05
    assert ([item.name for item in changed.fixtures], changed.instruction) == (["shelf"], "Take it.")


@pytest.mark.parametrize("path", ["object.box.x", "objects.crate.x", "objects.7.x"])
def test_a_path_that_leads_nowhere_is_named(path):
    with pytest.raises(InputError, match=f"here: set.{path}"):
        change_task(load_task_file("pick-box"), {"set": {path: 1}}, "here")


def test_a_change_that_makes_no_task_is_refused():
    with pytest.raises(InputError, match="here"):
        change_task(load_task_file("pick-box"), {"set": {"time_limit_s": -1.0}}, "here")

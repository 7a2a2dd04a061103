"""The types of the facts are those of the JSON that goes into questions and memories."""

import types
from typing import Any, Literal, NotRequired, Union, get_args, get_origin, get_type_hints, is_typeddict

import numpy as np
import pytest

from coral.contact.scene.facts import SceneFacts, on_table
from coral.contact.scene.task_names import shipped_tasks


def strays(value, kind, where=""):
    """Where a value is not what a type says, field by field."""
    origin = get_origin(kind)
    if origin in (Union, types.UnionType):
        found = [strays(value, one, where) for one in get_args(kind)]
        return [] if [] in found else min(found, key=len)
    if kind is Any:
        return []
    if is_typeddict(kind):
        if not isinstance(value, dict):
            return [where]
        hints = get_type_hints(kind)
        # Not __required_keys__: it takes no notice of NotRequired where annotations are postponed.
        needed = {
            key for key, one in get_type_hints(kind, include_extras=True).items() if get_origin(one) != NotRequired
        }
        wrong = [f"{where}.{key}" for key in (set(value) - set(hints)) | (needed - set(value))]
        return wrong + [s for key in set(value) & set(hints) for s in strays(value[key], hints[key], f"{where}.{key}")]
    if origin is list:
        (one,) = get_args(kind)
        return [s for item in value for s in strays(item, one, f"{where}[]")] if type(value) is list else [where]
    if origin is dict:
        (_, one) = get_args(kind)
        return [s for key, item in value.items() for s in strays(item, one, f"{where}.{key}")]
    if origin is Literal:
        return [] if value in get_args(kind) else [where]
    return [] if type(value) is kind or (kind is float and type(value) is int) else [where]


@pytest.mark.parametrize("task", shipped_tasks())
def test_the_facts_of_every_shipped_task_are_what_their_type_says(scene, task):
    facts = scene(task).facts
    assert strays(facts, SceneFacts) == []
    assert strays({**facts, "hand": {**facts["hand"], "more": 1}}, SceneFacts)


def test_a_point_over_the_tables_rim_is_on_it_and_one_beyond_is_not():
    table = {"x": [-0.1, 0.3], "y": [-0.2, 0.2]}
    assert on_table(table, np.array([0.3, -0.2]))
    assert not on_table(table, np.array([0.31, 0.0, 0.0]))
    assert not on_table(table, np.array([0.0, 0.21, 0.0]))

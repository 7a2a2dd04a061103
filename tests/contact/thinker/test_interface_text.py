"""The reference in a prompt: every name is found in it, and what many things have is described once."""

import re
from itertools import product

import pytest
from contact_bench import seen

from coral.contact.control.quantities import task_schema_of
from coral.contact.cost.context import Quantity
from coral.contact.cost.schema import object_quantities, scenery_quantities
from coral.contact.scene.task_names import every_task
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.interface_text import LEGEND, interface_text
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.thinker.scene_text import scene_text, told_in_scene


def lines_of(schema, told=()):
    return interface_text(schema, told).splitlines()[1:-1]


def named(schema, objects, told=()):
    """All names that the text stands for, its general ones written out."""
    found = set()
    for line in lines_of(schema, told):
        if not line.startswith("- "):
            continue
        names, _, about = line[2:].partition(": ")
        things = [one.split(" ")[0] for one in about.partition("(THING: ")[2].partition(")")[0].split(", ")]
        for part in names.split(", "):
            name = re.split(r"[\[? ]", part)[0]
            for owner, thing in product(objects if "NAME" in name else [""], things):
                if owner != thing or not owner:
                    found.add(name.replace("NAME", owner).replace("THING", thing))
    return found


@pytest.mark.parametrize("task", every_task())
def test_every_quantity_of_a_task_is_named_and_nothing_else(task):
    trial = sample_trial(load_task(task), 0)
    schema = task_schema_of(trial.task)
    facts = scene_facts(trial, seen(trial))
    told = told_in_scene(facts)
    scene = scene_text(facts)
    assert all(f"self.{name}" in scene for name in told if not name.endswith("_seen"))
    objects = [item.name for item in trial.task.objects]
    assert named(schema, objects) == set(schema)
    assert named(schema, objects, told) == set(schema) - told


def test_what_all_objects_or_things_have_is_described_once():
    schema = {
        **object_quantities("cup", [], ["table", "shelf"], ["jar"]),
        **object_quantities("jar", [], ["table", "shelf"], ["cup"]),
        **scenery_quantities(["shelf", "wall"], ["goal", "mark"]),
    }
    lines = lines_of(schema)
    assert "(NAME is one of cup, jar.)" in lines
    assert (
        "- NAME_THING_contact?, NAME_THING_clearance m: whether NAME touches THING; shortest distance of NAME and "
        "THING (THING: table, shelf, jar, cup other than NAME)" in lines
    )
    assert any(
        line.startswith("- THING_hand_force[3] N, THING_hand_contact?, THING_palm_contact?, THING_hand_clearance m: ")
        and line.endswith("(THING: cup, jar, table, shelf, wall)")
        for line in lines
    )
    assert "- THING_pos[3] m, THING_size[3] m: centre, full extents of THING (THING: shelf, wall)" in lines
    assert "- NAME_mass kg, NAME_friction: believed mass, friction coefficient of NAME" in lines


def test_what_one_object_alone_has_keeps_its_name():
    schema = {
        **object_quantities("box", [], ["table"], ["box_lid"]),
        **object_quantities("box_lid", ["knob"], ["table"], ["box"]),
    }
    lines = lines_of(schema)
    assert "- box_lid_knob_pos[3] m: the knob of the box_lid" in lines
    assert any(line.startswith("- NAME_THING_contact?, ") for line in lines)
    assert any(line.startswith("- box_pos[3] m: origin of the box's") for line in lines_of(object_quantities("box")))


def test_names_that_do_not_follow_from_a_general_one_are_listed():
    schema = {**object_quantities("cup", [], [], ["jar"]), **object_quantities("jar", [], ["table"])}
    assert any(line.startswith("- cup_jar_contact, jar_table_contact?:") for line in lines_of(schema))


def test_the_kind_and_the_unit_of_a_quantity_are_told():
    schema = {
        "goal_pos": Quantity(3, "m", "Its place."),
        "lit": Quantity(0, "", "Whether it is lit.", truth=True),
        "count": Quantity(0, "", "How many."),
    }
    assert interface_text(schema).splitlines()[:4] == [
        LEGEND,
        "- goal_pos[3] m: Its place.",
        "- lit?: Whether it is lit.",
        "- count: How many.",
    ]


def test_descriptions_are_not_joined_in_the_middle_of_a_thought():
    schema = {
        "held_s": Quantity(0, "s", "time since the stage began"),
        "ee_then_pos": Quantity(3, "m", "ee_pos when the stage began"),
    }
    assert len(lines_of(schema)) == 2

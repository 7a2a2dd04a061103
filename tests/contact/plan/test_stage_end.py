import numpy as np
import pytest

from coral.contact.cost_program import CostError
from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer, in_process
from coral.contact.plan.stage_end import TRUTH, UNKNOWN, parts_of, stage_ends

CODE = "def state_cost(self):\n    return norm(self.ee_pos - self.box_pos)"


@pytest.fixture
def one(scene):
    return scene("pick-box")


def told(one, condition):
    """Text, comparison and unit of each part."""
    return [(part.text, part.operator, part.unit) for part in parts_of(condition, one.world.schema)]


def plan(*done):
    return PlanAnswer(stages=[StageAnswer(name=f"s{k}", code=CODE, done=text) for k, text in enumerate(done)])


def read(one, condition):
    return stage_ends(plan(condition, ""), one.world.schema)["s0"].read(one.world.present(one.now))


def test_a_condition_is_taken_apart_at_its_outermost_and(one):
    assert told(one, "norm(self.ee_pos - self.box_pos) < 0.02 and (self.box_left_contact and self.time >= 1)") == [
        ("norm(self.ee_pos - self.box_pos) < 0.02", "<", "m"),
        ("self.box_left_contact", "holds", TRUTH),
        ("self.time >= 1", ">=", "s"),
    ]
    assert told(one, "0.1 < self.box_pos[2] < 0.2") == [
        ("0.1 < self.box_pos[2]", "<", "m"),
        ("self.box_pos[2] < 0.2", "<", "m"),
    ]
    assert told(one, "") == told(one, "norm(") == []


def test_a_negated_condition_holds_where_its_parts_fail(one):
    assert told(one, "not (self.box_table_contact or self.box_pos[2] < 0.1)") == [
        ("not (self.box_table_contact)", "fails", TRUTH),
        ("not self.box_pos[2] < 0.1", ">=", "m"),
    ]
    assert told(one, "not (self.box_left_contact and self.time > 1)")[0][1:] == ("fails", UNKNOWN)


def test_a_part_of_another_form_holds_or_does_not(one):
    text = "self.time > 1 or self.box_left_contact"
    assert told(one, text) == [(text, "holds", UNKNOWN)]
    assert told(one, f"({text}) and self.ee_pos[2] > 0.1") == [
        (text, "holds", UNKNOWN),
        ("self.ee_pos[2] > 0.1", ">", "m"),
    ]
    now = read(one, "self.time > 100 or self.ee_pos[2] > 0.0")
    assert [reading.holds for reading in now] == [True]
    assert [reading.holds for reading in read(one, "self.time > 100 or self.ee_pos[2] < 0.0")] == [False]


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("norm(self.ee_pos + 0.1 * quat_axis(self.box_quat, 0)) < 0.1", "m"),
        ("2.0 + quat_axis(self.ee_quat, 2)[2] < 0.05", ""),
        ("norm(self.box_vel) < 0.01", "m/s"),
        ("self.box_left_contact + self.box_right_contact >= 2", TRUTH),
        ("self.box_left_contact * self.ee_pos[2] > 0.1", UNKNOWN),
        ("norm(self.box_vel) + norm(self.ee_pos) < 0.01", UNKNOWN),
        ("self.ee_pos[0] ** 2 + self.ee_pos[1] ** 2 < 0.01", UNKNOWN),
        ("sqrt(self.ee_pos[0] ** 2 + self.ee_pos[1] ** 2) < 0.01", "m"),
    ],
)
def test_a_comparison_has_the_unit_of_what_it_reads(one, text, unit):
    assert [part.unit for part in parts_of(text, one.world.schema)] == [unit]


def test_the_sides_of_each_comparison_tell_how_far_it_is_from_holding(one):
    now = read(one, "self.box_pos[2] > 0.2 and self.gripper_opening > 0.01 and self.box_left_contact")
    height = one.now.objects["box"].position[2]
    assert [reading.holds for reading in now] == [False, True, False]
    assert now[0].missing == pytest.approx(0.2 - height, abs=1e-3)
    assert (now[1].missing, now[2].left, now[2].right) == (0.0, 0.0, 0.5)
    assert [reading.holds for reading in read(one, "not self.box_left_contact and not self.box_pos[2] > 0.2")] == [
        True,
        True,
    ]


def test_all_parts_hold_exactly_where_the_condition_does(one):
    place = one.now.objects["box"].position
    for bound in np.linspace(-0.1, 0.1, 5):
        text = f"0.0 < self.box_pos[0] + {bound} and not self.box_pos[1] >= {bound} and self.box_pos[2] != {bound}"
        holds = place[0] + bound > 0.0 and not place[1] >= bound
        assert all(reading.holds for reading in read(one, text)) == holds


def test_nothing_ends_the_last_stage_and_an_end_that_cannot_be_loaded_is_left_out(one):
    def refusing(source, schema, name):
        if name == "s1":
            raise CostError("killed", "the process is gone")
        return in_process(source, schema, name)

    done = "self.time > 1"
    assert set(stage_ends(plan(done, done, "", done), one.world.schema, refusing)) == {"s0"}


def test_where_a_side_cannot_be_evaluated_nothing_is_read(one):
    assert read(one, "1.0 / (self.box_pos[0] - self.box_pos[0]) > 1.0") == ()

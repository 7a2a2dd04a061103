"""Numbers of a plan that were sizes or places."""

import pytest

from coral.contact.memory.expressions import SizeExpression, find_expressions, lengths_in, replace_lengths
from coral.contact.plan.cost_plan import PlanAnswer

NUMBERS = {
    "object0.size.0": 0.06234,
    "object0.size.1": 0.09,
    "object0.size.2": 0.07187,
    "object0.up": 2.0,
    "goal.lifted.object0.height_m": 0.1,
    "place.wall.low.0": 0.2,
    "place.goal.2": 0.004,
}


def found(*lines):
    plan = PlanAnswer(code="\n    ".join(["def state_cost(self):", *lines]))
    return {key: one.text() for key, one in find_expressions(plan, NUMBERS).items()}


@pytest.mark.parametrize(
    ("line", "key", "text"),
    [
        ("return norm(self.ee_pos - np.array([0, 0, 0.0109]))", "0.0109 along z", "0.5 object0.size.2 - 0.025"),
        ("depth = 0.0312", "0.0312", "0.5 object0.size.0"),
        ("return abs(self.gripper_target - 0.0249)", "0.0249", "0.4 object0.size.0"),
        (
            "return self.box_pos - 0.055 * quat_axis(self.box_quat, 1)",
            "0.055 along side 1",
            "0.5 object0.size.1 + 0.01",
        ),
        (
            "return self.box_pos[2] - self.box_init_pos[2] - 0.125",
            "0.125 along z",
            "goal.lifted.object0.height_m + 0.025",
        ),
        ("return np.array([0.2, 0, 0]) - self.box_pos", "0.2 along x", "place.wall.low.0"),
        ("return self.box_pos[2] - 0.0399", "0.0399 along z", "0.5 object0.size.2 + place.goal.2"),
    ],
)
def test_a_length_that_equals_a_share_and_a_margin_is_an_expression(line, key, text):
    assert found(line) == {key: text}


@pytest.mark.parametrize(
    "line",
    [
        "return 0.0312 * norm(self.ee_vel)",
        "return norm(self.ee_pos) / 0.0312",
        "return clip(self.ee_pos[0], 0.0, 0.0312)",
        "return norm(self.ee_pos) < 0.02",
        "return self.box_pos[0] - 0.125",
        "return np.array([0, 0.2, 0]) - self.box_pos",
        "return 2.0312 + self.ee_pos[0]",
        "return quat_axis(self.box_quat, 0)[2] > 0.11",
        "return np.array([0, 0, 0.0312]) - self.box_pos",
    ],
)
def test_weights_tolerances_and_lengths_along_other_axes_stay(line):
    assert found(line) == {}


def test_an_expression_has_a_value_where_the_scene_has_its_numbers():
    half = SizeExpression(shares={"object0.size.2": 0.5}, margin_m=0.01)
    assert half.value({"object0.size.2": 0.1}) == pytest.approx(0.06)
    assert half.value({"object1.size.2": 0.1}) is None


def test_lengths_are_replaced_where_they_stand_and_nowhere_else():
    program = "def state_cost(self):\n    d = 0.0312  # 0.0312\n    return 0.0312 * norm(self.ee_pos - d) - 0.0312"
    assert replace_lengths(program, {"0.0312": 0.05}) == (
        "def state_cost(self):\n    d = 0.05  # 0.0312\n    return 0.0312 * norm(self.ee_pos - d) - 0.05"
    )


def test_one_number_may_mean_two_things_along_two_axes():
    program = "self.ee_pos - np.array([0.2, 0, 0.2])"
    assert [one.key for one in lengths_in(program)] == ["0.2 along x", "0.2 along z"]
    assert replace_lengths(program, {"0.2 along x": 0.255}) == "self.ee_pos - np.array([0.255, 0, 0.2])"


def test_a_length_that_is_nearly_the_same_stays_as_it_is_written():
    assert replace_lengths("self.ee_pos - 0.0312", {"0.0312": 0.03117}) == "self.ee_pos - 0.0312"


def test_letters_of_two_bytes_do_not_move_a_length():
    assert replace_lengths("x = 'µ' if a else 0.1 + 0.0312", {"0.0312": 0.05}) == "x = 'µ' if a else 0.1 + 0.05"


@pytest.mark.parametrize("program", ["", "def (", "x = [" * 200])
def test_what_is_no_program_has_no_lengths(program):
    assert lengths_in(program) == []
    assert replace_lengths(program, {"0.0312": 0.05}) == program

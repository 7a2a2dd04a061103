import ast

import numpy as np
import pytest

from coral.contact.mistakes import program_edits as edit

NAMED = """def state_cost(self):
    off = self.ee_pos - self.box_pos - np.array([0.0, 0.0, 0.1])
    terms['reach'] = 12.0 * norm(off)
    terms['square'] = 4.0 * abs(dot(quat_axis(self.ee_quat, 1), quat_axis(self.box_quat, 0)))
    return terms
"""
SUM = "def state_cost(self):\n    return 2.0 * norm(self.ee_pos) + abs(self.box_pos[2] - 0.1) + 1.0 * self.box_tilt"

RETURNED = "def state_cost(self):\n    d = self.ee_pos\n    return {'reach': 12.0 * norm(d), 'height': abs(d[2] - 0.1)}"


def rng():
    return np.random.default_rng(0)


@pytest.mark.parametrize("code", [NAMED, SUM, RETURNED])
@pytest.mark.parametrize("change", [edit.flip_sign, edit.scale_term, edit.drop_term])
def test_one_term_is_changed_and_the_rest_stays(code, change):
    before = ast.unparse(ast.parse(code)).splitlines()
    after = change(code, rng()).splitlines()
    assert after != before
    assert len(set(before) - set(after)) == 1


def test_a_cost_of_one_term_has_none_to_lose():
    assert edit.drop_term("def state_cost(self):\n    return norm(self.ee_pos)", rng()) is None


@pytest.mark.parametrize(("code", "was"), [(NAMED, (0.0, 0.0, 0.1)), (SUM, (0.1,)), (RETURNED, (0.1,))])
def test_a_place_moves_by_some_centimetres(code, was):
    def numbers(text):
        return [node.value for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant)]

    def texts(values):
        return [value for value in values if isinstance(value, float)]

    made = edit.shift_place(code, rng(), (0.03, 0.08))
    moved = [abs(abs(b) - abs(a)) for a, b in zip(texts(numbers(code)), texts(numbers(made)), strict=False) if a != b]
    assert len(was) in (1, 3)
    assert len(moved) == 1
    assert 0.03 <= moved[0] <= 0.08


def test_an_axis_is_not_taken_for_a_place():
    code = "def state_cost(self):\n    return dot(self.box_vel, np.array([1, 0, 0]))"
    assert edit.shift_place(code, rng(), (0.03, 0.08)) is None


def test_objects_turn_and_the_hand_does_not():
    code = "dot(quat_axis(self.ee_quat, 0), quat_axis(self.box_quat, 0))"
    assert edit.turn_axis(code, 0) == "dot(quat_axis(self.ee_quat, 0), -quat_axis(self.box_quat, 0))"
    assert edit.turn_axis(code, 1) is None
    assert edit.turn_axis(NAMED, 0) is None  # a grasp is the same from both sides


@pytest.mark.parametrize(
    ("condition", "strict"),
    [("norm(self.ee_pos) < 0.02", 0.0002), ("self.box_pos[2] > 0.1", 0.3), ("self.raised > 0.98", 1.47)],
)
def test_a_condition_becomes_one_that_never_holds(condition, strict):
    (bound,) = [node.value for node in ast.walk(ast.parse(edit.tighten(condition))) if isinstance(node, ast.Constant)][
        -1:
    ]
    assert bound == pytest.approx(strict) or str(strict) in edit.tighten(condition)


def test_what_compares_with_no_number_stays():
    assert edit.tighten("self.box_left_contact and self.box_right_contact") is None
    assert edit.flip_sign("def state_cost(self:", rng()) is None

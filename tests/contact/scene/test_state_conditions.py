"""The present state of one object, judged on worlds made by hand: just in, just out, and the near misses."""

import dataclasses

import numpy as np
import pytest
from contact_bench import body, make_trial, plain, touch, truth, written

from coral.errors import InputError

FINGERS = (touch("box", "left"), touch("box", "right"))
UP = (0, 0, 0.16)


def watch(drawn_changes=None, **condition):
    trial = make_trial(condition, **(drawn_changes or {}))
    return trial.task.success.conditions[0].monitor(trial)


@pytest.mark.parametrize(
    ("z", "contacts", "holds"),
    [
        (0.1301, FINGERS, True),
        (0.1299, FINGERS, False),
        (0.2, (), True),
        (0.2, (*FINGERS, touch("box", "wall")), False),  # rubbed up the wall
        (0.2, (*FINGERS, touch("box", "robot")), True),  # an arm link brushes it
        (0.2, (*FINGERS, touch("table", "wall")), True),
    ],
)
def test_lifted(z, contacts, holds):
    assert watch(kind="lifted", height_m=0.1)(truth(0, body((0, 0, z)), *contacts)) is holds


def test_lifted_means_the_lowest_point():
    tilted = body((0, 0, 0.131), (45, 0, 0))
    assert not watch(kind="lifted", height_m=0.1)(truth(0, tilted, *FINGERS))


@pytest.mark.parametrize(
    ("contacts", "holds"),
    [
        (FINGERS, True),
        (FINGERS[:1], False),
        ((touch("box", "hand"),), False),
        ((FINGERS[0], touch("right", "wall")), False),
    ],
)
def test_grasped(contacts, holds):
    assert watch(kind="grasped")(truth(0, body(UP), *contacts)) is holds


@pytest.mark.parametrize(
    ("contacts", "holds"),
    [
        ((), True),
        ((touch("box", "table"), touch("hand", "table")), True),
        (FINGERS[1:], False),
        ((touch("box", "hand"),), False),
    ],
)
def test_released(contacts, holds):
    assert watch(kind="released")(truth(0, body(), *contacts)) is holds


@pytest.mark.parametrize(
    ("position", "rpy", "options", "holds"),
    [
        ((0.149, 0, 0.5), (0, 0, 0), {}, True),
        ((0.151, 0, 0.5), (0, 0, 0), {}, False),
        ((0.14, 0.04, 0.03), (0, 0, 0), {}, False),
        ((0.1, 0, 0.081), (0, 0, 0), {"axes": "xyz"}, False),
        ((0.1, 0, 0.079), (0, 0, 0), {"axes": "xyz"}, True),
        ((0.9, 0.049, 0), (0, 0, 0), {"axes": "y"}, True),
        ((0.07, -0.03, 0.03), (0, 0, 0), {"point": "corner"}, True),
        ((0.07, -0.03, 0.03), (0, 0, 180), {"point": "corner"}, False),
    ],
)
def test_at(position, rpy, options, holds):
    judge = watch(kind="at", place="goal", tolerance_m=0.05, **options)
    assert judge(truth(0, body(position, rpy))) is holds


@pytest.mark.parametrize(
    ("velocity", "spin", "contacts", "holds"),
    [
        ((0.019, 0, 0), (0, 0, 0.29), (touch("box", "table"),), True),
        ((0.021, 0, 0), (0, 0, 0), (touch("box", "table"),), False),
        ((0, 0, 0), (0, 0, 0.31), (touch("box", "table"),), False),
        ((0, 0, 0), (0, 0, 0), (touch("box", "wall"),), False),
        ((0, 0, 0), (0, 0, 0), (), False),
    ],
)
def test_resting(velocity, spin, contacts, holds):
    assert watch(kind="resting")(truth(0, body(velocity=velocity, spin=spin), *contacts)) is holds


@pytest.mark.parametrize(
    ("rpy", "holds"),
    [
        ((0, 90, 0), True),
        ((-90, 0, 0), True),
        ((0, 76, 0), True),
        ((0, 74, 0), False),
        ((0, 106, 0), False),
        ((0, 0, 90), False),
        ((180, 0, 0), False),
        ((90, 0, 70), True),
    ],
)
def test_flipped(rpy, holds):
    assert watch(kind="flipped")(truth(0, body(rpy_deg=rpy))) is holds


def test_flipped_counts_from_how_it_stood():
    laid = {"objects": [plain()["objects"][0] | {"rpy_deg": [90, 0, 0]}]}
    judge = watch(laid, kind="flipped", axis="z")
    assert not judge(truth(0, body(rpy_deg=(90, 0, 0))))
    assert judge(truth(0, body()))


@pytest.mark.parametrize(
    ("rpy", "holds"), [((0, 0, 170), True), ((14, 0, 0), True), ((16, 0, 0), False), ((180, 0, 0), False)]
)
def test_upright(rpy, holds):
    assert watch(kind="upright")(truth(0, body(rpy_deg=rpy))) is holds


@pytest.mark.parametrize(
    ("position", "holds"), [((0.03, 0.03, 0.05), True), ((0.051, 0, 0.03), False), ((0, 0, 0.09), False)]
)
def test_undisturbed(position, holds):
    assert watch(kind="undisturbed")(truth(0, body(position))) is holds


@pytest.mark.parametrize(
    ("place", "holds"),
    [
        ((0, 0, 0.05), True),
        ((0.1, 0, 0.05), True),
        ((0.101, 0, 0.05), False),
        ((0, 0.3, 0.05), False),
        ((0, 0, -0.01), False),
    ],
)
def test_inside(place, holds):
    judge = watch(kind="inside", low=(-0.1, -0.2, 0.0), high=(0.1, 0.2, 0.1))
    assert judge(truth(0, body(place))) is holds


def test_inside_nothing(tmp_path):
    nothing = {"kind": "inside", "object": "box", "low": [0.0, 0.0, 0.2], "high": [0.1, 0.1, 0.1]}
    with pytest.raises(InputError, match="all below high"):
        written(tmp_path, plain() | {"success": {"conditions": [nothing]}})


@pytest.mark.parametrize(("z", "holds"), [(0.189, True), (0.191, False)])
def test_lifted_not_too_high(z, holds):
    assert watch(kind="lifted", height_m=0.1, most_m=0.16)(truth(0, body((0, 0, z)), *FINGERS)) is holds


def pinched(*points):
    return [
        dataclasses.replace(touch("box", finger), point=np.array(point, dtype=float))
        for finger, point in zip(("left", "right"), points, strict=True)
    ]


@pytest.mark.parametrize(
    ("points", "holds"),
    [
        (((0.03, 0.03, 0.06), (0.03, 0.03, 0.09)), True),
        (((0.03, 0.03, 0.06), (-0.03, -0.03, 0.06)), False),
    ],
)
def test_grasped_at_a_point(points, holds):
    judge = watch(kind="grasped", point="corner", within_m=0.04)
    assert judge(truth(0, body(), *pinched(*points))) is holds


@pytest.mark.parametrize(("thing", "holds"), [("hand", True), ("table", False), ("wall", False)])
def test_touching(thing, holds):
    assert watch(kind="touching", thing=thing)(truth(0, body(), FINGERS[0])) is holds


@pytest.mark.parametrize(
    ("velocity", "spin", "holds"),
    [((0.04, 0, 0), (0, 0, 0.4), True), ((0.06, 0, 0), (0, 0, 0), False), ((0, 0, 0), (0, 0, 0.6), False)],
)
def test_still(velocity, spin, holds):
    assert watch(kind="still")(truth(0, body(velocity=velocity, spin=spin))) is holds


@pytest.mark.parametrize(
    ("rpy", "options", "holds"),
    [
        ((0, 90, 0), {"direction": (2, 0, 0)}, True),
        ((0, 76, 0), {"direction": (1, 0, 0)}, True),
        ((0, 74, 0), {"direction": (1, 0, 0)}, False),
        ((0, -90, 0), {"direction": (1, 0, 0)}, False),
        ((0, -90, 0), {"direction": (1, 0, 0), "either_way": True}, True),
        ((0, 90, 0), {"direction": (0, 0, -1), "axis": "x"}, True),
    ],
)
def test_pointing(rpy, options, holds):
    assert watch(kind="pointing", **options)(truth(0, body(rpy_deg=rpy))) is holds


@pytest.mark.parametrize(("rpy", "holds"), [((0, 0, 90), True), ((14, 0, 0), True), ((80, 0, 0), False)])
def test_what_was_tipped_over_was_disturbed(rpy, holds):
    assert watch(kind="undisturbed")(truth(0, body(rpy_deg=rpy))) is holds


@pytest.mark.parametrize(("x", "holds"), [(0.02, True), (-0.04, False)])
def test_a_point_may_be_what_is_inside(x, holds):
    judge = watch(kind="inside", point="corner", low=(0.0, 0.0, 0.0), high=(0.1, 0.1, 0.1))
    assert judge(truth(0, body((x, 0, 0.03)))) is holds


def test_a_direction_of_nothing_and_a_height_out_of_order_are_refused(tmp_path):
    for condition, expected in (
        ({"kind": "pointing", "direction": [0.0, 0.0, 0.0]}, "not all zero"),
        ({"kind": "lifted", "height_m": 0.2, "most_m": 0.1}, "more than height_m, 0.2"),
    ):
        with pytest.raises(InputError, match=expected):
            written(tmp_path, plain() | {"success": {"conditions": [condition | {"object": "box"}]}})


@pytest.mark.parametrize(
    ("condition", "at", "found"),
    [
        ({"kind": "at", "place": "goal", "tolerance_m": 0.03}, body((0.154, 0, 0.03)), "5.4 cm, allowed 3 cm"),
        ({"kind": "lifted", "height_m": 0.1}, body((0, 0, 0.1)), "7 cm, wanted 10 cm"),
        ({"kind": "flipped"}, body(UP, (20, 0, 0)), "20°, allowed 90° ± 15°"),
        ({"kind": "pointing", "direction": [0, 0, 1]}, body(UP, (20, 0, 0)), "20° off, allowed 15°"),
        ({"kind": "released"}, body(UP), ""),
    ],
)
def test_what_was_found_is_told_beside_what_is_allowed(condition, at, found):
    trial = make_trial(condition)
    assert trial.task.success.conditions[0].found(trial, truth(0, at)) == found

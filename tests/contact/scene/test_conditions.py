"""Success, judged on worlds made by hand: just in, just out, and the near misses."""

import pytest
from contact_bench import body, make_trial, plain, touch, truth, written

from coral.errors import InputError

FINGERS = (touch("box", "left"), touch("box", "right"))
UP = (0, 0, 0.16)


def watch(drawn_changes=None, **condition):
    trial = make_trial(condition, **(drawn_changes or {}))
    return trial.task.success.conditions[0].monitor(trial)


def shown(judge, *states):
    """What a watch says after the last of (time, pose, contacts...)."""
    said = None
    for state in states:
        said = judge(truth(*state))
    return said


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


def flip(angles, touched, turn="pitch", step_s=0.05, start_s=0.0):
    """States of a flip; the wall is touched at angles within `touched`."""
    states = []
    for k, angle in enumerate(angles):
        rpy = (0, angle, 0) if turn == "pitch" else (0, 0, angle)
        contacts = (touch("box", "wall"),) if touched[0] <= angle <= touched[1] else ()
        states.append((start_s + k * step_s, body(rpy_deg=rpy), *contacts))
    return states


FLIP = (0, 0, 0, 5, 10, 20, 30, 40, 50, 60, 70, 80, 90, 90, 90)


@pytest.mark.parametrize(
    ("touched", "holds"),
    [
        ((0, 90), True),
        ((30, 40), True),
        ((30, 30), False),  # a tap of one step
        ((0, 10), False),
        ((80, 90), False),  # only before, only after
        ((999, 999), False),
    ],
)
def test_touched_while_turning(touched, holds):
    assert shown(watch(kind="touched-while-turning", thing="wall"), *flip(FLIP, touched)) is holds


def test_a_flip_with_the_wall_stays_one_until_set_down_again():
    judge = watch(kind="touched-while-turning", thing="wall")
    assert shown(judge, *flip(FLIP, (20, 60)))
    assert judge(truth(2, body(rpy_deg=(0, 90, 0))))
    assert not judge(truth(3, body()))
    assert not shown(judge, *flip(FLIP[3:], (999, 999), start_s=3.1))


def test_a_flip_without_the_wall_does_not_become_one_by_leaning_on_it():
    judge = watch(kind="touched-while-turning", thing="wall")
    assert not shown(judge, *flip(FLIP, (999, 999)))
    assert not shown(judge, *flip((80, 70, 70, 70, 70, 80, 90), (70, 70), start_s=1.0))
    assert not shown(judge, *flip((40, 20, 20, 20, 30, 50, 90), (20, 50), start_s=2.0))


def test_tipping_a_little_against_the_wall_and_the_rest_in_the_fingers_is_no_flip_with_it():
    judge = watch(kind="touched-while-turning", thing="wall")
    assert not shown(judge, *flip((0, 10, 20, 20, 20, 20, 20, 25, 40, 60, 80, 90), (0, 20)))


def test_falling_back_half_way_and_going_on_with_the_wall_is_one():
    judge = watch(kind="touched-while-turning", thing="wall")
    assert shown(judge, *flip((0, 20, 30, 40, 20, 30, 40, 60, 90), (20, 90)))


def test_turning_on_the_spot_beside_the_wall_is_no_flip():
    assert not shown(watch(kind="touched-while-turning", thing="wall"), *flip(FLIP, (0, 90), "yaw"))


def test_the_time_before_the_first_look_does_not_count():
    judge = watch(kind="touched-while-turning", thing="wall")
    assert not judge(truth(100.0, body(rpy_deg=(0, 40, 0)), touch("box", "wall")))
    steady = watch(kind="steady-force", newtons=5)
    assert not steady(truth(100.0, body(velocity=(0.05, 0, 0)), touch("hand", "box", (5, 0, 0))))


def push(forces, speed=0.05, step_s=0.02):
    """States of a push along x with these forces (N; None where nothing touches)."""
    return [
        (k * step_s, body(velocity=(speed, 0, 0)), *(() if force is None else (touch("hand", "box", (force, 0, 0)),)))
        for k, force in enumerate(forces)
    ]


@pytest.mark.parametrize(
    ("forces", "speed", "holds"),
    [
        ([5.0] * 60, 0.05, True),
        ([6.9] * 60, 0.05, True),
        ([7.1] * 60, 0.05, False),
        ([2.9] * 60, 0.05, False),
        ([5.0] * 60, 0.004, False),  # it does not move
        ([5.0] * 40, 0.05, False),  # too short
        (([10.0] * 15 + [0.0] * 15) * 4, 0.05, False),  # the right mean in slow bursts
        ([10.0, None] * 60, 0.05, False),  # taps
        ([5.0] * 40 + [20.0] * 20, 0.05, False),
        ([5.0] * 90 + [20.0] * 15, 0.05, True),
    ],
)
def test_steady_force(forces, speed, holds):
    assert shown(watch(kind="steady-force", newtons=5), *push(forces, speed)) is holds


def test_force_is_the_hands_net_force_and_not_the_squeeze():
    squeeze = (
        touch("left", "box", (0, 20, 0)),
        touch("right", "box", (0, -20, 0)),
        touch("hand", "box", (5, 0, 0)),
        touch("box", "table", (0, 0, -50)),
    )
    judge = watch(kind="steady-force", newtons=5)
    said = [judge(truth(0.02 * k, body(velocity=(0.05, 0, 0)), *squeeze)) for k in range(60)]
    assert said[-1]


def test_force_of_a_hand_that_comes_second_by_name():
    box = plain()["objects"][0] | {"name": "tin"}
    trial = make_trial({"kind": "steady-force", "newtons": 5, "object": "tin", "for_s": 0.1}, objects=[box])
    judge = trial.task.success.conditions[0].monitor(trial)
    moving = body(velocity=(0.05, 0, 0))
    said = [
        judge(truth(0.02 * k, None, touch("right", "tin", (3, 0, 0)), touch("tin", "hand", (-2, 0, 0)), tin=moving))
        for k in range(12)
    ]
    assert said[-1]


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

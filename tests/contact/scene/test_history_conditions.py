"""What has happened since the episode began, judged on worlds made by hand."""

import numpy as np
import pytest
from contact_bench import body, make_trial, plain, touch, truth

from coral.contact.scene.condition import BaseCondition
from coral.contact.scene.observation import HandForce, Truth


def watch(**condition):
    trial = make_trial(condition)
    return trial.task.success.conditions[0].monitor(trial)


def shown(judge, *states):
    """What a watch says after the last of (time, pose, contacts...)."""
    said = None
    for state in states:
        said = judge(truth(*state))
    return said


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


def forced(time_s, newtons, peak=None, velocity=0.05):
    """A moment of a push, with the force measured over the control step."""
    mean = None if newtons is None else np.array([newtons, 0.0, 0.0])
    forces = {"box": HandForce(mean, (newtons or 0.0) if peak is None else peak)}
    return Truth(time_s, body(), 0.08, {"box": body(velocity=(velocity, 0, 0))}, (), forces)


@pytest.mark.parametrize(
    ("forces", "holds"),
    [
        ([6.0] * 100, True),
        ([7.9] * 100, True),
        ([8.1] * 100, False),
        ([12.0] * 5 + [0.1] * 5, False),  # hammering at 5 Hz: right on average
        ([6.0] * 90 + [14.0] * 5, True),
        ([6.0] * 90 + [14.0] * 10, False),
    ],
)
def test_steady_force_seldom_deviates(forces, holds):
    judge = watch(kind="steady-force", newtons=6, deviation_n=2)
    forces = forces * (10 if len(forces) == 10 else 1)
    said = [judge(forced(0.02 * k, force)) for k, force in enumerate(forces)]
    assert said[-1] is holds


def test_the_measured_mean_counts_and_not_the_contact_at_the_steps_end():
    judge = watch(kind="steady-force", newtons=6)
    said = [judge(forced(0.02 * k, 6.0)) for k in range(60)]
    assert said[-1]


@pytest.mark.parametrize(
    ("window_s", "forces", "peaks", "holds"),
    [
        (0, [5, 9.9, 5], [5, 9.9, 5], True),
        (0, [5, 5, 5], [5, 10.1, 5], False),  # within one control step
        (0, [5, 10.1, 5], [5, 5, 5], False),
        (0.06, [0, 28, 0, 0], [28] * 4, True),  # 9.3 N over 0.06 s
        (0.06, [0, 31, 0, 0], [31] * 4, False),
        (0.06, [28, 28, 0, 0], [28] * 4, False),
        (0.06, [31, 0, 0], [31] * 3, False),  # before a whole window has passed
        (0.06, [None, None, None], [0] * 3, True),
    ],
)
def test_peak_force(window_s, forces, peaks, holds):
    judge = watch(kind="peak-force", newtons=10, window_s=window_s)
    said = [judge(forced(0.02 * k, *both)) for k, both in enumerate(zip(forces, peaks, strict=True))]
    assert said[-1] is holds


@pytest.mark.parametrize(("angles", "holds"), [((0, 14, 0), True), ((0, 16, 0), False)])
def test_kept_level(angles, holds):
    judge = watch(kind="kept-level")
    assert shown(judge, *((0.1 * k, body(rpy_deg=(angle, 0, 90 * k))) for k, angle in enumerate(angles))) is holds


@pytest.mark.parametrize(("ways", "holds"), [((0, 0.039, 0), True), ((0, 0.041, 0), False)])
def test_kept_near(ways, holds):
    judge = watch(kind="kept-near", distance_m=0.04)
    assert shown(judge, *((0.1 * k, body((way, 0, 0.03))) for k, way in enumerate(ways))) is holds


@pytest.mark.parametrize(("steps", "holds"), [(10, True), (11, False)])
def test_kept_touching_forgives_a_chatter(steps, holds):
    judge = watch(kind="kept-touching")
    on, off = [touch("box", "table")], []
    contacts = [on, *[off] * steps, on, on]
    assert shown(judge, *((0.02 * k, body(), *found) for k, found in enumerate(contacts))) is holds


@pytest.mark.parametrize(
    ("thing", "contact", "holds"),
    [
        ("hand", ("box", "left"), False),
        ("hand", ("box", "table"), True),
        ("wall", ("box", "wall"), False),
        ("robot", ("box", "robot"), False),
        ("robot", ("box", "hand"), True),
    ],
)
def test_never_touched(thing, contact, holds):
    judge = watch(kind="never-touched", thing=thing)
    assert shown(judge, (0.0, body(), touch(*contact)), (0.02, body())) is holds


@pytest.mark.parametrize(
    ("contacts", "holds"),
    [
        (("hand", "table"), True),
        (("table",), False),  # it slides by itself
        (("hand",), False),  # carried
    ],
)
def test_slid(contacts, holds):
    judge = watch(kind="slid", distance_m=0.1)
    found = [touch("box", one) for one in contacts]
    assert shown(judge, *((0.02 * k, body((0.002 * k, 0, 0.03)), *found) for k in range(51))) is holds


def test_an_object_that_slides_on_after_a_push_was_slid_only_for_a_moment():
    judge = watch(kind="slid", distance_m=0.1)
    states = [(0.02 * k, body((0.004 * k, 0, 0.03)), touch("box", "table")) for k in range(60)]
    states[0] = (*states[0], touch("box", "hand"))
    assert not shown(judge, *states)


def test_only_conditions_that_cannot_be_mended_break_for_good():
    kinds = [*BaseCondition.__subclasses__()]
    good = {one.model_fields["kind"].default for one in kinds if one.breaks_for_good}
    assert good >= {"peak-force", "kept-level", "kept-touching", "never-touched"}
    assert not good & {"slid", "steady-force", "touched-while-turning", "at", "lifted", "still"}
    assert {one.model_fields["kind"].default for one in kinds if one.reads_forces} >= {"peak-force", "steady-force"}


@pytest.mark.parametrize(
    ("condition", "breach"),
    [
        ({"kind": "peak-force", "newtons": 5.0}, (body(), touch("hand", "box", (9, 0, 0)))),
        ({"kind": "kept-level"}, (body(rpy_deg=(0, 60, 0)),)),
        ({"kind": "never-touched", "thing": "wall"}, (body(), touch("box", "wall"))),
    ],
)
def test_what_breaks_for_good_never_holds_again(condition, breach):
    judge = watch(object="box", **condition)
    assert shown(judge, (0.0, body()))
    assert not shown(judge, (0.1, *breach))
    assert not shown(judge, *((0.2 + 0.1 * k, body()) for k in range(20)))

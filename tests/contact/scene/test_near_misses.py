"""The six tasks: what their instruction asks for passes, and what comes near to it does not."""

import numpy as np
import pytest
from contact_bench import touch
from judged_trial import STEP_S, JudgedTrial, still

from coral.contact.scene.geometry import from_rotvec, multiply
from coral.contact.scene.observation import BodyState

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)


@pytest.mark.parametrize(
    ("axis", "degrees", "succeeds"),
    [
        (Y, 90, True),  # its top away from the robot, on its broad side
        (Y, -90, False),  # towards the robot
        (X, 90, False),  # on its narrow side
        (X, -90, False),
        (Y, 70, False),  # leaning
    ],
)
def test_flip_box_to_the_side_that_is_asked_for(axis, degrees, succeeds):
    one = JudgedTrial("flip-box")
    assert one.succeeds(still(one.turned(axis, degrees), [touch("box", "table")])) is succeeds


@pytest.mark.parametrize(
    ("axis", "degrees", "succeeds"),
    [
        (Y, 90, True),  # the near end rose; it stands on the end beside the wall
        (Y, 76, False),  # left leaning on the wall
        (X, 90, False),  # on its long side
        (Y, -90, False),  # on the other end
    ],
)
def test_flip_wall_ends_standing_on_its_end(axis, degrees, succeeds):
    one = JudgedTrial("flip-wall")
    wall = [touch("box", "table"), touch("box", "wall")]
    rise = [(one.turned(axis, share * degrees), wall) for share in np.linspace(0, 1, 60)]
    assert one.succeeds([*rise, *still(one.turned(axis, degrees), wall)]) is succeeds


HELD = [touch("box", "left"), touch("box", "right")]


@pytest.mark.parametrize(
    ("turn", "up", "velocity", "contacts", "succeeds"),
    [
        (0, 0.12, (0, 0, 0), HELD, True),
        (0, 0.12, (0, 0, 0), [*HELD, touch("box", "robot")], True),  # an arm link brushes it
        (180, 0.12, (0, 0, 0), HELD, False),  # upside down
        (0, 0.5, (0, 0, 0), HELD, False),  # far too high
        (0, 0.12, (0, 0, 0.3), HELD, False),  # it still rises
        (0, 0.12, (0, 0, 0), HELD[:1], False),
    ],
)
def test_pick_box_holds_it_still_upright_at_its_height(turn, up, velocity, contacts, succeeds):
    one = JudgedTrial("pick-box")
    assert one.succeeds(still(one.turned(X, turn, (0, 0, up), velocity), contacts)) is succeeds


def board_held(one, at_y):
    """The board held by two fingers at a point of its own y axis, 8 cm up."""
    up = one.turned(Z, 0, (0, 0.12, 0.1))
    point = one.trial.point(one.name, "handle", up) + np.array([0, at_y, 0])
    return still(up, [touch_at("board", "left", point), touch_at("board", "right", point)])


def touch_at(first, second, point):
    made = touch(first, second)
    return type(made)(made.first, made.second, made.force, np.asarray(point, dtype=float))


def board_pushed(one, way, contacts=("hand", "table")):
    found = [touch("board", other) for other in contacts]
    return [(one.turned(Z, 0, (0, share * way, 0)), found) for share in np.linspace(0, 1, 100)]


@pytest.mark.parametrize(
    ("way", "contacts", "at_y", "succeeds"),
    [
        (0.18, ("hand", "table"), 0.0, True),
        (0.0, ("hand", "table"), 0.0, False),  # lifted where it lay, never pushed
        (0.18, ("hand",), 0.0, False),  # carried over the edge
        (0.18, ("hand", "table"), -0.3, False),  # held by its blade
    ],
)
def test_the_board_is_pushed_over_the_edge_and_held_by_its_handle(way, contacts, at_y, succeeds):
    one = JudgedTrial("push-pick-board")
    assert one.succeeds([*board_pushed(one, way, contacts), *board_held(one, at_y)]) is succeeds


@pytest.mark.parametrize(("axis", "succeeds"), [(Z, True), (X, False)])
def test_pick_clutter_leaves_the_block_standing(axis, succeeds):
    one = JudgedTrial("pick-clutter")
    block = one.trial.objects["block"].pose
    tipped = BodyState(block.position, multiply(block.quaternion, from_rotvec(np.radians(80) * np.array(axis))))
    goal = np.array([*one.trial.task.places["goal"][:2], 0.05])
    there = {"can": BodyState(goal, one.start.quaternion), "block": tipped}
    assert one.succeeds(still(there, [touch("can", "mat")])) is succeeds


def steady(t):
    return 6.0


def hammering(t):
    return 12.0 if int(t * 10) % 2 == 0 else 0.1  # 5 Hz


def one_blow(t):
    return 40.0 if abs(t - 2.0) < 0.011 else 6.0


def pushed(one, force=steady, turn=0, up=0.0, pace=0.04):
    """The block moved evenly from its start to the goal under these forces, then left there."""
    way = np.array([*one.trial.task.places["goal"][:2], 0]) - one.start.position * [1, 1, 0]
    seconds = np.linalg.norm(way) / pace
    contacts = [touch("block", "hand", (-6, 0, 0)), *([] if up else [touch("block", "table")])]
    states = []
    for t in np.arange(0, seconds, STEP_S):
        at = one.turned(X, turn, (*(way * t / seconds)[:2], up), pace * way / np.linalg.norm(way))
        states.append((at, contacts, force(t)))
    return [*states, *still(one.turned(X, turn, (*way[:2], 0.0)), [touch("block", "table")])]


@pytest.mark.parametrize(
    ("how", "succeeds"),
    [
        ({}, True),
        ({"force": hammering}, False),
        ({"force": one_blow}, False),
        ({"up": 0.05}, False),  # carried through the air
        ({"turn": 90}, False),  # on its side
    ],
)
def test_push_force_is_steady_and_along_the_table(how, succeeds):
    one = JudgedTrial("push-force")
    assert one.succeeds(pushed(one, **how)) is succeeds


def test_push_force_does_not_count_a_block_that_slides_through_the_goal():
    one = JudgedTrial("push-force")
    before_rest = pushed(one)[:-50]
    speed = before_rest[-1][0].velocity
    through = [
        (
            BodyState(before_rest[-1][0].position + speed * k * STEP_S, one.start.quaternion, speed),
            before_rest[-1][1],
            6,
        )
        for k in range(30)
    ]
    assert not one.succeeds([*before_rest, *through])

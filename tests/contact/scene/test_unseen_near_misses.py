"""The unseen suite: what an instruction asks for passes, and what comes near to it does not."""

import numpy as np
import pytest
from judged_trial import JudgedTrial, at_rest, gripped, on_joint, placed, slid, still, touches

from coral.contact.scene.geometry import from_rotvec
from coral.contact.scene.observation import BodyState
from coral.contact.scene.task_names import suite_tasks
from coral.contact.scene.trial import move_joint

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
JUDGED = set()
"""Tasks whose near misses are tried below."""


def near_misses(task, cases):
    """Parametrize a test over its task's cases: keyword arguments, and whether they succeed."""
    JUDGED.add(task)
    return pytest.mark.parametrize(("how", "succeeds"), cases, ids=[f"{task}-{k}" for k in range(len(cases))])


def swung(one, to, force=0.0, end=()):
    """States in which the first object is moved on its joint to a position (degrees or m), and left there."""
    joint = one.trial.task.objects[0].joint
    now = one.trial.joint_position(one.name, one.start)
    goal = np.radians(to) if joint.kind == "hinge" else to
    poses = [move_joint(joint, one.start, share * (goal - now)) for share in np.linspace(0, 1, 60)]
    moved = [(pose, touches(one.name, "hand"), force) for pose in poses]
    return [*moved, *still(poses[-1], touches(one.name, *end))]


@near_misses(
    "slide-to-stop",
    [
        ({}, True),
        ({"end": ("table",)}, False),  # before the stop
        ({"end": ("table", "stop", "hand")}, False),  # still held
        ({"things": ("hand",)}, False),  # carried
        ({"to": (0.0, -0.02)}, False),  # slid a few centimetres only
    ],
)
def test_slide_to_stop(how, succeeds):
    one = JudgedTrial("slide-to-stop")
    given = {"to": (0.0, 0.075), "things": ("hand", "table"), "end": ("table", "stop")} | how
    way = slid(one, given["to"], given["things"])
    assert one.succeeds([*way, *still(at_rest(way[-1][0]), touches("tile", *given["end"]))]) is succeeds


@near_misses(
    "drag-card-out",
    [
        ({}, True),
        ({"to": (0.0, 0.0)}, False),  # its far end is under the shelf
        ({"things": ("hand", "table", "shelf")}, False),
        ({"things": ("hand",)}, False),  # lifted out
        ({"end": ("table", "hand")}, False),
    ],
)
def test_drag_card_out(how, succeeds):
    one = JudgedTrial("drag-card-out")
    given = {"to": (-0.08, 0.0), "things": ("hand", "table"), "end": ("table",)} | how
    way = slid(one, given["to"], given["things"])
    assert one.succeeds([*way, *still(at_rest(way[-1][0]), touches("card", *given["end"]))]) is succeeds


@near_misses(
    "wipe-stroke",
    [
        ({}, True),
        ({"force": 0.8}, False),  # pushed along, not pressed
        ({"force": 40.0}, False),
        ({"things": ("hand",)}, False),
        ({"to": (0.03, -0.02)}, False),
    ],
)
def test_wipe_stroke(how, succeeds):
    one = JudgedTrial("wipe-stroke")
    given = {"to": (0.08, -0.06), "things": ("hand", "table"), "force": 8.0} | how
    way = slid(one, **given)
    assert one.succeeds([*way, *still(at_rest(way[-1][0]), touches("sponge", "table"))]) is succeeds


@near_misses(
    "wipe-to-and-fro",
    [
        ({}, True),
        ({"marks": [(0.0, -0.1)]}, False),  # never at the left mark
        ({"marks": [(0.0, -0.1), (0.0, 0.1)]}, False),  # the other way round
        ({"force": 0.8}, False),
    ],
)
def test_wipe_to_and_fro(how, succeeds):
    one = JudgedTrial("wipe-to-and-fro")
    given = {"marks": [(0.0, 0.1), (0.0, -0.1)], "force": 6.0} | how
    states = []
    for mark in given["marks"]:
        states += slid(one, mark, force=given["force"])
        one.start = at_rest(states[-1][0])
    assert one.succeeds([*states, *still(one.start, touches("sponge", "table"))]) is succeeds


SWUNG = [
    ("turn-lever", {"to": 82}, True),
    ("turn-lever", {"to": 60}, False),
    ("turn-lever", {"to": 82, "end": ("hand",)}, False),
    ("open-door", {"to": 70}, True),
    ("open-door", {"to": 50}, False),
    ("open-door", {"to": 70, "force": 60.0}, False),  # with a blow
    ("open-door", {"to": 70, "end": ("hand",)}, False),
    ("close-drawer", {"to": 0.0}, True),
    ("close-drawer", {"to": 0.012}, False),  # ajar
    ("close-drawer", {"to": 0.0, "force": 60.0}, False),
    ("close-lid", {"to": 0}, True),
    ("close-lid", {"to": 8}, False),
    ("close-lid", {"to": 0, "force": 60.0}, False),  # knocked shut
    ("close-lid", {"to": 0, "end": ("hand",)}, False),
]
JUDGED |= {task for task, *_ in SWUNG}


@pytest.mark.parametrize(("task", "how", "succeeds"), SWUNG)
def test_what_is_on_a_joint(task, how, succeeds):
    one = JudgedTrial(task)
    assert one.succeeds(swung(one, **how)) is succeeds


@near_misses(
    "open-drawer",
    [
        ({}, True),
        ({"to": 0.06}, False),
        ({"held": ()}, False),  # drawn by its edge
        ({"held": (0.0, 0.02)}, False),  # begun by the handle, and drawn on by its edge
        ({"held": (0.05, 0.2)}, False),  # the handle only in the end
    ],
)
def test_open_drawer(how, succeeds):
    one = JudgedTrial("open-drawer")
    given = {"to": 0.1, "held": (0.0, 0.2)} | how
    opening = np.linspace(0.0, given["to"], 60)
    way = []
    for at in opening:
        body = on_joint(one, "drawer", at)
        held = given["held"] and given["held"][0] <= at <= given["held"][1]
        way.append((body, gripped(one, "drawer", body, "handle") if held else touches("drawer", "hand")))
    assert one.succeeds([*way, *still(way[-1][0], [])]) is succeeds


def turned_bar(one, degrees, about):
    """The bar turned about a point of it (m along its axis from its middle) that keeps its place."""
    out = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.0])
    fixed = np.array([about, 0.0, one.start.position[2]])
    return BodyState(fixed - about * out, from_rotvec([0, 0, np.radians(degrees)]))


@near_misses(
    "pivot-bar",
    [
        ({}, True),
        ({"to": 70}, False),
        ({"about": 0.0}, False),  # about its middle
        ({"to": -90}, False),  # to the right
        ({"things": ("hand",)}, False),  # carried
        ({"end": ("table", "hand")}, False),
        ({"off": 0.2}, False),  # its near end left the stop on the way
    ],
)
def test_pivot_bar(how, succeeds):
    one = JudgedTrial("pivot-bar")
    given = {"to": 90, "about": -0.1, "things": ("hand", "table"), "end": ("table",), "off": 0.0} | how
    shares = np.linspace(0, 1, 60)
    poses = [turned_bar(one, share * given["to"], given["about"]) for share in shares]
    for pose, share in zip(poses, shares, strict=True):
        pose.position[0] += given["off"] * np.sin(np.pi * share)
    way = [(pose, touches("bar", *given["things"])) for pose in poses]
    assert one.succeeds([*way, *still(poses[-1], touches("bar", *given["end"]))]) is succeeds


@near_misses(
    "scoop-box",
    [
        ({}, True),
        ({"things": ("hand", "table")}, False),  # raised clear of the wall
        ({"degrees": 75}, False),  # left leaning
        ({"degrees": -90}, False),  # on its near end
        ({"end": ("table", "wall", "hand")}, False),
    ],
)
def test_scoop_box(how, succeeds):
    one = JudgedTrial("scoop-box")
    given = {"degrees": 90, "things": ("hand", "table", "wall"), "end": ("table", "wall")} | how
    angles = np.linspace(0, given["degrees"], 60)
    way = [(placed(one, "box", axis=Y, degrees=angle), touches("box", *given["things"])) for angle in angles]
    assert one.succeeds([*way, *still(way[-1][0], touches("box", *given["end"]))]) is succeeds


INSERTED = [
    ({}, True),
    ({"up": 0.03}, False),  # not deep enough
    ({"aside": 0.04}, False),
    ({"degrees": 30}, False),  # askew
    ({"end": "hand"}, False),
]
JUDGED |= {"insert-peg", "insert-block"}


@pytest.mark.parametrize(("how", "succeeds"), INSERTED)
@pytest.mark.parametrize("task", ["insert-peg", "insert-block"])
def test_inserted(task, how, succeeds):
    one = JudgedTrial(task)
    given = {"up": 0.0, "aside": 0.0, "degrees": 0.0, "end": "table"} | how
    x, y, _ = one.trial.task.places["goal"]
    at = placed(one, one.name, (x + given["aside"], y, one.start.position[2] + given["up"]), X, given["degrees"])
    assert one.succeeds(still(at, touches(one.name, given["end"]))) is succeeds


@near_misses(
    "pull-from-under-block",
    [
        ({}, True),
        ({"card": (-0.05, 0.0)}, False),  # still under the block
        ({"degrees": 40}, False),  # the block toppled
        ({"block": ("card",)}, False),  # the block still on the card
        ({"on_the_way": ("hand",)}, False),  # the block was held by hand
    ],
)
def test_pull_from_under_block(how, succeeds):
    one = JudgedTrial("pull-from-under-block")
    given = {"card": (-0.13, 0.0), "degrees": 0.0, "block": ("table",), "on_the_way": ("card",)} | how
    way = [(state, [*made, *touches("block", *given["on_the_way"])]) for state, made, _ in slid(one, given["card"])]
    end = {"card": at_rest(way[-1][0]), "block": placed(one, "block", (None, None, 0.03), Y, given["degrees"])}
    assert one.succeeds([*way, *still(end, touches("card", "table") + touches("block", *given["block"]))]) is succeeds


@near_misses(
    "stack-blocks",
    [
        ({}, True),
        ({"top": (0.105, -0.1, 0.08)}, False),  # over its edge
        ({"base": (0.08, -0.07, 0.025)}, False),  # pushed away
        ({"held": ("hand",)}, False),
        ({"degrees": 90}, False),  # on its side
    ],
)
def test_stack_blocks(how, succeeds):
    one = JudgedTrial("stack-blocks")
    given = {"top": (0.08, -0.1, 0.08), "base": None, "held": (), "degrees": 0.0} | how
    end = {"top": placed(one, "top", given["top"], X, given["degrees"]), "base": placed(one, "base", given["base"])}
    assert one.succeeds(still(end, touches("top", "base", *given["held"]))) is succeeds


@near_misses(
    "unstack-blocks",
    [
        ({}, True),
        ({"degrees": 90}, False),  # laid on its side
        ({"base": 30.0}, False),  # the lower one tipped
        ({"on": ("table",)}, False),  # beside the mat
        ({"on": ("mat", "hand")}, False),
    ],
)
def test_unstack_blocks(how, succeeds):
    one = JudgedTrial("unstack-blocks")
    given = {"degrees": 0.0, "base": 0.0, "on": ("mat",)} | how
    end = {
        "top": placed(one, "top", (0.1, -0.18, 0.034), X, given["degrees"]),
        "base": placed(one, "base", None, X, given["base"]),
    }
    assert one.succeeds(still(end, touches("top", *given["on"]))) is succeeds


@near_misses(
    "push-gently",
    [({}, True), ({"force": 20.0}, False), ({"things": ("hand",)}, False), ({"to": (0.08, 0.0)}, False)],
)
def test_push_gently(how, succeeds):
    one = JudgedTrial("push-gently")
    way = slid(one, **{"to": (0.12, 0.0), "force": 5.0} | how)
    assert one.succeeds([*way, *still(at_rest(way[-1][0]), touches("crate", "table"))]) is succeeds


@near_misses(
    "push-past-glass",
    [
        ({}, True),
        ({"brushed": "hand"}, False),
        ({"brushed": "crate"}, False),
        ({"to": (0.08, 0.0)}, False),
        ({"things": ("hand",)}, False),  # carried
    ],
)
def test_push_past_glass(how, succeeds):
    one = JudgedTrial("push-past-glass")
    way = slid(one, how.get("to", (0.12, 0.0)), how.get("things", ("hand", "table")))
    brushed = touches("glass", how["brushed"]) if "brushed" in how else []
    way[5] = (way[5][0], [*way[5][1], *brushed])
    assert one.succeeds([*way, *still(at_rest(way[-1][0]), touches("crate", "table"))]) is succeeds


@near_misses(
    "carry-level",
    [({}, True), ({"tilt": 30.0}, False), ({"on": ("table",)}, False), ({"on": ("shelf", "hand")}, False)],
)
def test_carry_level(how, succeeds):
    one = JudgedTrial("carry-level")
    way = [(placed(one, "cup", (0.0, 0.0, 0.2), X, how.get("tilt", 10.0)), touches("cup", "hand"))] * 10
    end = placed(one, "cup", (0.12, -0.15, 0.09))
    assert one.succeeds([*way, *still(end, touches("cup", *how.get("on", ("shelf",))))]) is succeeds


@near_misses(
    "topple-gently",
    [
        ({}, True),
        ({"degrees": -90}, False),  # towards the robot
        ({"axis": X}, False),  # onto its narrow side
        ({"degrees": 50}, False),  # leaning
        ({"force": 25.0}, False),
    ],
)
def test_topple_gently(how, succeeds):
    one = JudgedTrial("topple-gently")
    given = {"axis": Y, "degrees": 90, "force": 5.0} | how
    pushed = [(one.start, touches("carton", "hand"), given["force"])] * 20
    end = placed(one, "carton", None, given["axis"], given["degrees"])
    assert one.succeeds([*pushed, *still(end, touches("carton", "table"))]) is succeeds


def test_every_task_has_a_near_miss():
    assert set(suite_tasks("unseen")) == JUDGED

"""The suite of long tasks: what an instruction asks for passes, and what comes near to it does not."""

import numpy as np
import pytest
from judged_trial import JudgedTrial, gripped, on_joint, placed, slid, still, touches

from coral.contact.scene.observation import BodyState
from coral.contact.scene.task_names import suite_tasks

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
JUDGED = set()
"""Tasks whose near misses are tried below."""


def near_misses(task, *misses):
    """Parametrize a test over what its task asks for, {}, and over near misses: keyword arguments."""
    JUDGED.add(task)
    cases = [({}, True), *((how, False) for how in misses)]
    return pytest.mark.parametrize(("how", "succeeds"), cases, ids=[f"{task}-{k}" for k in range(len(cases))])


def moving(body, m_s=0.1):
    """The same body on its way."""
    return BodyState(body.position, body.quaternion, np.array([m_s, 0.0, 0.0]))


def moment(bodies, *contacts):
    """A few equal states: objects by name, and pairs that touch."""
    return [(bodies, [one for name, *things in contacts for one in touches(name, *things)])] * 10


@near_misses(
    "dominoes",
    {"blue": 0},  # the last one stands
    {"green": 0},
    {"red": 0},
    {"speed": 0.1},  # still falling
    {"red": -90, "green": -90, "blue": -90},  # towards the robot
    {"blue": 65},  # leans on something
    {"way": "green"},  # touched by the hand
    {"way": "blue"},
    {"end": "hand"},
)
def test_dominoes(how, succeeds):
    one = JudgedTrial("dominoes")
    given = {"red": 70, "green": 72, "blue": 90, "way": "red", "end": "green", "speed": 0.0} | how
    fallen = {name: placed(one, name, axis=Y, degrees=given[name]) for name in ("red", "green", "blue")}
    fallen["blue"] = moving(fallen["blue"], given["speed"])
    way = moment({}, (given["way"], "hand"))
    assert one.succeeds([*way, *still(fallen, touches("red", given["end"]))]) is succeeds


@near_misses(
    "bridge",
    {"on": ("near_post", "table")},  # its far end slid off
    {"on": ("far_post", "table")},
    {"on": ("near_post", "far_post", "hand")},
    {"at": (0.085, -0.12, 0.11)},  # held above
    {"at": (0.125, -0.12, 0.06)},  # as good as on one post
)
def test_bridge(how, succeeds):
    one = JudgedTrial("bridge")
    given = {"at": (0.085, -0.12, 0.06), "on": ("near_post", "far_post")} | how
    assert one.succeeds(still(placed(one, "plank", given["at"]), touches("plank", *given["on"]))) is succeeds


@near_misses(
    "sweep",
    {"blue": -0.12},  # not wholly beyond
    {"red": -0.08},
    {"way": ("hand",)},  # lifted over the line
    {"way": ("hand",), "odd": "red"},
    {"degrees": 90},
    {"degrees": 90, "odd": "red"},
    {"toppled": 90},  # and set up again
    {"toppled": 90, "odd": "red"},
    {"end": ("table", "hand")},
    {"end": ("table", "hand"), "odd": "red"},
)
def test_sweep(how, succeeds):
    one = JudgedTrial("sweep")
    given = {
        "red": -0.16,
        "blue": -0.16,
        "way": ("hand", "table"),
        "degrees": 0,
        "toppled": 20,  # it may tilt on the way
        "end": ("table",),
        "odd": "blue",
    } | how
    odd, other = given["odd"], "red" if given["odd"] == "blue" else "blue"
    way = moment({odd: placed(one, odd, None, X, given["toppled"])}, (other, "table"), (odd, *given["way"])) * 2
    end = {
        other: placed(one, other, (None, given[other], None)),
        odd: placed(one, odd, (None, given[odd], None), X, given["degrees"]),
    }
    lie = touches(other, "table") + touches(odd, *given["end"])
    assert one.succeeds([*way, *still(end, lie)]) is succeeds


@near_misses(
    "turn-tile",
    {"to": 70},
    {"to": -90},
    {"off": 0.07},  # moved too far on the way, and back again
    {"way": ("hand",)},
    {"end": ("table", "hand")},
    {"speed": 0.1},
)
def test_turn_tile(how, succeeds):
    one = JudgedTrial("turn-tile")
    given = {"to": 90, "off": 0.0, "way": ("hand", "table"), "end": ("table",), "speed": 0.0} | how
    x = one.start.position[0]
    shares = np.linspace(0, 1, 40)
    turns = [
        placed(one, "tile", (x + given["off"] * np.sin(np.pi * share), None, None), Z, share * given["to"])
        for share in shares
    ]
    way = [(pose, touches("tile", *given["way"])) for pose in turns]
    assert one.succeeds([*way, *still(moving(turns[-1], given["speed"]), touches("tile", *given["end"]))]) is succeeds


@near_misses(
    "drawer-fetch",
    {"drawer": 0.02},  # closed again
    {"cube": (-0.08, -0.11, 0.0175)},  # beside the mat
    {"on": ("hand", "table")},
    {"on": ("drawer",)},
    {"held": (False, False)},  # drawn by its edge
    {"held": (True, False)},
    {"held": (False, True)},
)
def test_drawer_fetch(how, succeeds):
    one = JudgedTrial("drawer-fetch")
    given = {"drawer": 0.12, "cube": (-0.08, -0.16, 0.0175), "on": ("table",), "held": (True, True)} | how
    way = []
    for at, held in zip((0.0, 0.1), given["held"], strict=True):
        body = on_joint(one, "drawer", at)
        way += [({"drawer": body}, gripped(one, "drawer", body, "handle") if held else touches("drawer", "hand"))] * 10
    end = {"drawer": on_joint(one, "drawer", given["drawer"]), "cube": placed(one, "cube", given["cube"])}
    assert one.succeeds([*way, *still(end, touches("cube", *given["on"]))]) is succeeds


@near_misses(
    "swap-cans",
    {"red": (0.05, 0.12, 0.05)},  # only blue is where it should be
    {"blue": (0.05, 0.08, 0.05)},
    {"degrees": 90},  # lying
    {"degrees": 90, "odd": "blue"},
    {"held": ("hand",)},
    {"held": ("hand",), "odd": "blue"},
)
def test_swap_cans(how, succeeds):
    one = JudgedTrial("swap-cans")
    given = {"red": (0.05, -0.12, 0.05), "blue": (0.05, 0.12, 0.05), "degrees": 0, "held": (), "odd": "red"} | how
    end = {
        name: placed(one, name, given[name], X, given["degrees"] * (name == given["odd"])) for name in ("red", "blue")
    }
    assert one.succeeds(still(end, touches(given["odd"], "table", *given["held"]))) is succeeds


@near_misses(
    "uncover-cube",
    {"cube": (None, None, None)},  # the box is off, the cube where it was
    {"cube": (0.05, -0.11, 0.0175)},  # beside the mat
    {"degrees": 90},  # the box knocked over
    {"cover": ("hand", "table")},  # the box still held
    {"cover": ("cube",)},  # the box over the cube again
    {"on": ("hand", "table")},
    {"on": ("cover",)},
    {"by": None},  # lifted by its edge
    {"up": 0.0},  # shoved off
)
def test_uncover_cube(how, succeeds):
    one = JudgedTrial("uncover-cube")
    given = {"cube": (0.05, -0.15, 0.0175), "degrees": 0, "cover": ("table",), "on": ("table",)} | how
    by, up = given.get("by", "knob"), given.get("up", 0.08)
    way = []
    for high, under in ((0.0, ["table"]), (up, [] if up else ["table"])):
        body = placed(one, "cover", (None, None, one.trial.objects["cover"].pose.position[2] + high))
        held = gripped(one, "cover", body, by) if by else touches("cover", "hand")
        way += [({"cover": body}, held + touches("cover", *under))] * 10
    end = {
        "cover": placed(one, "cover", (-0.12, 0.12, None), X, given["degrees"]),
        "cube": placed(one, "cube", given["cube"]),
    }
    lie = touches("cube", *given["on"]) + touches("cover", *given["cover"])
    assert one.succeeds([*way, *still(end, lie)]) is succeeds


@near_misses(
    "poke-out",
    {"cube": 0.215},  # its rear is in the tunnel
    {"way": ("stick", "hand")},
    {"way": ()},  # not by the stick
    {"end": ("hand",)},
    {"back": 0.2},  # out, and drawn in again
    {"speed": 0.1},
)
def test_poke_out(how, succeeds):
    one = JudgedTrial("poke-out")
    given = {"cube": 0.25, "way": ("stick",), "end": ("table",), "speed": 0.0} | how
    way = moment({}, ("cube", *given["way"])) + moment({"cube": placed(one, "cube", (given["cube"], 0.0, None))})
    out = {"cube": moving(placed(one, "cube", (given.get("back", given["cube"]), 0.0, None)), given["speed"])}
    assert one.succeeds([*way, *still(out, touches("cube", "table") + touches("stick", *given["end"]))]) is succeeds


@near_misses(
    "tower",
    {"middle": "blue", "top": "green"},  # the other order
    {"red": (0.13, -0.1, 0.02)},  # moved
    {"aside": 0.03},
    {"beside": 0.03},
    {"hand": "blue"},  # still held
    {"hand": "green"},
    {"hand": "red"},
    {"under": "table"},
    {"over": "table"},
)
def test_tower(how, succeeds):
    one = JudgedTrial("tower")
    given = {"middle": "green", "top": "blue", "red": None, "aside": 0.0, "beside": 0.0} | how
    red = placed(one, "red", given["red"])
    x, y, z = red.position
    end = {
        "red": red,
        given["middle"]: placed(one, given["middle"], (x, y + given["beside"], z + 0.04)),
        given["top"]: placed(one, given["top"], (x + given["aside"], y + given["beside"], z + 0.08)),
    }
    lie = touches(given["middle"], given.get("under", "red")) + touches(
        given["top"], given.get("over", given["middle"])
    )
    lie += touches(given["hand"], "hand") if "hand" in given else []
    assert one.succeeds(still(end, lie)) is succeeds


@near_misses(
    "roll-ball",
    {"to": (0.12, -0.1)},  # half in
    {"things": ("hand",)},  # carried
    {"end": ("table", "hand")},
    {"speed": 0.1},  # still rolling
)
def test_roll_ball(how, succeeds):
    one = JudgedTrial("roll-ball")
    given = {"to": (0.18, -0.1), "things": ("hand", "table"), "end": ("table",), "speed": 0.0} | how
    way = slid(one, given["to"], given["things"])
    end = moving(way[-1][0], given["speed"])
    assert one.succeeds([*way, *still(end, touches("ball", *given["end"]))]) is succeeds


@near_misses(
    "clear-and-load",
    {"crate": (0.1, 0.0)},  # short of the mark
    {"things": ("hand",)},  # the crate was carried
    {"can": (0.14, 0.1, 0.095)},  # beside the crate
    {"on": "table"},
    {"degrees": 90},
    {"hand": "can"},
    {"hand": "crate"},
    {"speed": 0.1},  # the crate still slides
)
def test_clear_and_load(how, succeeds):
    one = JudgedTrial("clear-and-load")
    given = {"crate": (0.14, 0.0), "things": ("hand", "table"), "on": "crate", "degrees": 0, "speed": 0.0} | how
    way = slid(one, given["crate"], given["things"])
    crate = moving(way[-1][0], given["speed"])
    can = given.get("can", (*crate.position[:2], 0.095))
    end = {"crate": crate, "can": placed(one, "can", can, X, given["degrees"])}
    lie = touches("crate", "table") + touches("can", given["on"])
    lie += touches(given["hand"], "hand") if "hand" in given else []
    assert one.succeeds([*way, *still(end, lie)]) is succeeds


@near_misses(
    "levers-in-order",
    {"order": [(0, 85), (85, 85), (0, 85)]},  # blue first
    {"order": [(85, 0), (0, 0), (0, 85)]},  # red turned back too early
    {"order": [(85, 0), (85, 85)]},  # red not turned back
    {"order": [(85, 0), (85, 60), (0, 60)]},  # blue not far enough
    {"end": (40, 85)},  # in order, and then turned on
    {"end": (0, 40)},
    {"hand": "red"},
    {"hand": "blue"},
    {"moves": "red"},
    {"moves": "blue"},
)
def test_levers_in_order(how, succeeds):
    one = JudgedTrial("levers-in-order")
    given = {"order": [(85, 0), (85, 85), (0, 85)]} | how
    order = [*given["order"], given.get("end", given["order"][-1])]
    turned = [{"red": on_joint(one, "red", red), "blue": on_joint(one, "blue", blue)} for red, blue in order]
    way = [state for bodies in turned for state in moment(bodies, ("red", "hand"))]
    end = turned[-1] | {name: moving(turned[-1][name]) for name in [given.get("moves")] if name}
    held = touches(given["hand"], "hand") if "hand" in given else []
    assert one.succeeds([*way, *still(end, held)]) is succeeds


def test_every_task_has_a_near_miss():
    assert set(suite_tasks("long")) == JUDGED

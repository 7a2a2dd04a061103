"""What rests among several objects sleeps in a rollout, and wakes when it is touched; nothing else changes."""

from dataclasses import replace

import numpy as np
import pytest
from contact_bench import DOWN, body, make_trial, plain, seen

from coral.contact.control.planning_world import ControlSequences, PlanningCfg, PlanningWorld
from coral.contact.control.rollouts import SLEEP, RolloutStart, _split_into_slices
from coral.contact.scene.trial import PhysicalParameters

pytestmark = pytest.mark.skipif(not SLEEP, reason="this MuJoCo cannot sleep")
SUNK = 2e-5
"""How far (m) a light object at rest is pressed into the table."""
BELIEFS = {"box": PhysicalParameters(0.2, 0.5), "tin": PhysicalParameters(0.2, 0.5)}
TIN = {
    "name": "tin",
    "parts": [{"shape": "cylinder", "size": [0.06, 0.06, 0.04]}],
    "mass_kg": 0.2,
    "friction": 0.5,
    "x": 0,
    "y": 0.2,
}


def two(**places):
    """A box, 6 cm wide, and a tin 20 cm beside it: the trial, and what is measured."""
    trial = make_trial(objects=[*plain()["objects"], TIN])
    lying = {"box": lies(0.0), "tin": lies(0.2, 0.02 - SUNK)}
    return trial, seen(trial, **{"tool": (-0.08, 0.0, 0.03), "opening_m": 0.02} | lying | places)


def lies(y, z=0.03 - SUNK, **motion):
    return body((0.0, y, z), **motion)


def world(trial, now, **changes):
    return PlanningWorld(trial, BELIEFS, now, replace(PlanningCfg(threads=1), **changes))


def push(count=3, steps=15, start=-0.08):
    """The closed hand goes from beside the box into it, each a little otherwise."""
    way = np.linspace([start, 0, 0.03], [0.08, 0, 0.03], steps)
    position = way + np.random.default_rng(0).normal(scale=0.005, size=(count, steps, 3))
    return ControlSequences(position, np.tile(DOWN, (count, steps, 1)), np.full((count, steps), 0.02), 600.0)


def keep(now, steps=20):
    return ControlSequences(
        np.tile(now.tool.position, (1, steps, 1)),
        np.tile(now.tool.quaternion, (1, steps, 1)),
        np.full((1, steps), now.opening_m),
        600.0,
    )


def asleep(planner, now):
    """Names of the objects that sleep when a rollout begins."""
    model = planner.models[0]
    start = RolloutStart.at(model, planner._initial(now))
    trees = {name: int(model.body_treeid[model.body(name).id]) for name in BELIEFS}
    return {name for name, tree in trees.items() if start.data.tree_asleep[tree] >= 0}


def test_what_lies_still_sleeps():
    trial, now = two()
    assert asleep(world(trial, now), now) == {"box", "tin"}


@pytest.mark.parametrize(
    "box",
    [
        lies(0.0, velocity=(0.05, 0, 0)),
        lies(0.0, spin=(0, 0, 1.0)),
        lies(0.0, 0.2),
        lies(0.2, 0.12, velocity=(0, 0, -1)),
    ],
    ids=["slides", "turns", "in the air", "falls towards the tin"],
)
def test_what_moves_or_hangs_does_not(box):
    trial, now = two(box=box)
    assert asleep(world(trial, now), now) == {"tin"}


def test_what_the_hand_touches_does_not():
    trial, now = two(tool=(-0.0395, 0.0, 0.03))
    assert asleep(world(trial, now), now) == {"tin"}


def test_what_touches_something_awake_does_not():
    trial, now = two(box=lies(0.1405, velocity=(0.05, 0, 0)))
    assert asleep(world(trial, now), now) == set()


def test_two_that_lean_on_each_other_sleep_together():
    trial, now = two(box=lies(0.1405))
    assert asleep(world(trial, now), now) == {"box", "tin"}


def test_nothing_sleeps_where_that_is_switched_off():
    trial, now = two()
    assert not world(trial, now, rest_m_s=0.0).models[0].opt.enableflags & SLEEP


def test_an_object_alone_stays_awake():
    trial = make_trial()
    planner = PlanningWorld(trial, {"box": BELIEFS["box"]}, seen(trial), PlanningCfg(threads=1))
    assert not planner.models[0].opt.enableflags & SLEEP


def test_a_sleeper_stays_to_the_last_bit_and_keeps_its_contacts():
    trial, now = two()
    context, sane = world(trial, now).rollout(now, push())
    assert sane.all()
    assert (context.tin_pos == now.objects["tin"].position).all()
    assert not context.tin_vel.any()
    assert context.tin_table_contact.all()
    assert not context.tin_hand_contact.any()


def test_what_is_pushed_wakes_up_and_goes_as_far_as_if_it_had_been_awake():
    trial, now = two(tool=(-0.05, 0.0, 0.03))
    slowly = push(20, 75, -0.05)
    slept, _ = world(trial, now).rollout(now, slowly)
    awake, _ = world(trial, now, rest_m_s=0.0).rollout(now, slowly)
    ways = [float(np.median(each.box_pos[:, -1, 0])) for each in (slept, awake)]
    assert ways[0] > 0.05
    assert ways[0] == pytest.approx(ways[1], rel=0.03)


def test_what_is_pushed_wakes_what_it_runs_into():
    trial, now = two(tin=body((0.065, 0.0, 0.02 - SUNK)))
    context, _ = world(trial, now).rollout(now, push())
    assert asleep(world(trial, now), now) == {"box", "tin"}
    assert (context.tin_pos[:, -1, 0] > 0.07).all()


def test_what_one_rollout_wakes_still_sleeps_in_the_next():
    trial, now = two()
    alike = push(4)
    still = keep(now, 15)
    mixed = ControlSequences(
        *(
            np.concatenate([first, second, first])
            for first, second in (
                (alike.position, still.position),
                (alike.quaternion, still.quaternion),
                (alike.opening, still.opening),
            )
        ),
        600.0,
    )
    context, _ = world(trial, now).rollout(now, mixed)
    assert np.array_equal(context.box_pos[:4], context.box_pos[5:])
    assert (context.box_pos[4] == now.objects["box"].position).all()


@pytest.mark.parametrize("threads", [1, 2, 24])
@pytest.mark.parametrize("total", [1, 7, 200])
def test_parts_hold_everything_once_and_grow_smaller(total, threads):
    parts = _split_into_slices(total, threads)
    assert [k for part in parts for k in range(part.start, part.stop)] == list(range(total))
    sizes = [part.stop - part.start for part in parts]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] <= max(1, -(-total // (2 * threads)))
    assert sizes[-1] == 1


def test_threads_do_not_matter():
    trial, now = two()
    one, _ = world(trial, now).rollout(now, push(7))
    three, _ = world(trial, now, threads=3).rollout(now, push(7))
    for name in ("box_pos", "box_hand_force", "tin_pos", "ee_pos"):
        assert np.array_equal(one[name], three[name])


def test_what_hangs_in_the_air_falls():
    trial, now = two(box=lies(0.0, 0.2))
    context, _ = world(trial, now).rollout(now, keep(now))
    assert context.box_pos[0, -1, 2] == pytest.approx(0.03, abs=3e-3)


@pytest.mark.parametrize("position", [(np.nan, 0, 0.03), (0, 0, np.inf)])
def test_nothing_holds_from_a_mad_state(position, capfd):
    trial, now = two(box=body(position))
    context, sane = world(trial, now).rollout(now, push())
    assert not sane.any()
    assert np.isfinite(context.tin_pos).all()
    assert capfd.readouterr() == ("", "")


def test_several_beliefs_each_begin_from_their_own():
    trial, now = two()
    heavy = BELIEFS | {"box": PhysicalParameters(2.0, 0.9)}
    both = PlanningWorld(trial, [BELIEFS, heavy], now, PlanningCfg(threads=2))
    context, sane = both.rollout(now, push(3))
    assert sane.all()
    alone, _ = PlanningWorld(trial, heavy, now, PlanningCfg(threads=1)).rollout(now, push(3))
    assert np.array_equal(context.box_pos[3:], alone.box_pos)

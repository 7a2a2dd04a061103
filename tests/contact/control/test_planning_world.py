"""Rollouts: each as MuJoCo would step it alone, under what is believed, and safe from each other."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from contact_bench import DOWN, body, make_trial, plain, seen

from coral.contact.control.hand_model import set_stiffness
from coral.contact.control.planning_world import ControlSequences, PlanningCfg, PlanningWorld
from coral.contact.scene.trial import PhysicalParameters

CFG = PlanningCfg(threads=1)
LIGHT, HEAVY = {"box": PhysicalParameters(0.1, 0.3)}, {"box": PhysicalParameters(1.5, 0.6)}


def world(trial=None, beliefs=LIGHT, cfg=CFG):
    trial = trial or make_trial()
    return PlanningWorld(trial, beliefs, seen(trial), cfg)


def controls(positions, quaternion=DOWN, opening=0.02, stiffness=600.0):
    """Shape=(K, H, 3) targets, the hand otherwise kept."""
    positions = np.asarray(positions, dtype=float)
    shape = positions.shape[:2]
    return ControlSequences(positions, np.broadcast_to(quaternion, (*shape, 4)), np.full(shape, opening), stiffness)


def pushes(count=3, steps=12, seed=0):
    """The closed hand goes from beside the box into it, each a little otherwise."""
    way = np.linspace([-0.08, 0, 0.03], [0.06, 0, 0.03], steps)
    return way + np.random.default_rng(seed).normal(scale=0.01, size=(count, steps, 3))


def beside(trial):
    return seen(trial, tool=(-0.08, 0.0, 0.03), opening_m=0.02)


def test_each_rollout_is_what_stepping_it_alone_gives():
    trial = make_trial()
    planner, now, plan = world(trial), beside(trial), controls(pushes())
    planner.edges = True  # the same model for both
    context, sane = planner.rollout(now, plan)
    assert sane.all()
    model, states = planner.models[0], mujoco.mjtState.mjSTATE_FULLPHYSICS
    set_stiffness(model, CFG.hand, plan.stiffness)
    moved = []
    for k in range(3):
        data = mujoco.MjData(model)
        mujoco.mj_setState(model, data, planner._initial(now), states)
        for step in range(12):
            data.ctrl[:2] = plan.opening[k, step] / 2
            data.mocap_pos[0], data.mocap_quat[0] = plan.position[k, step], plan.quaternion[k, step]
            for _ in range(round(CFG.step_s / CFG.physics_dt_s)):
                mujoco.mj_step(model, data)
            assert context.box_pos[k, step] == pytest.approx(data.joint("box_free").qpos[:3], abs=1e-12)
            assert context.gripper_opening[k, step] == pytest.approx(
                data.joint("left_slide").qpos[0] + data.joint("right_slide").qpos[0], abs=1e-12
            )
        moved.append(data.joint("box_free").qpos[0])
    assert min(moved) > 0.01


def test_far_from_the_edges_the_table_is_a_plane_on_which_things_move_alike():
    trial = make_trial()
    flat, _ = world(trial).rollout(beside(trial), controls(pushes()))
    edged, _ = world(trial, cfg=PlanningCfg(threads=1, inland_m=9.0)).rollout(beside(trial), controls(pushes()))
    assert flat.box_pos[:, -1] == pytest.approx(edged.box_pos[:, -1], abs=2e-3)
    assert np.array_equal(flat.box_table_contact, edged.box_table_contact)


@pytest.mark.parametrize(("x", "falls"), [(0.28, False), (0.5, True)])
def test_what_is_near_an_edge_can_fall(x, falls):
    trial = make_trial()
    now = seen(trial, box=body((x, 0.0, 0.03)))
    context, _ = world(trial).rollout(now, controls(np.tile(now.tool.position, (1, 20, 1))))
    assert (context.box_pos[0, -1, 2] < 0.0) == falls


def test_nothing_sleeps_in_a_mujoco_that_cannot(monkeypatch):
    monkeypatch.setattr("coral.contact.control.rollouts.Rollouts.can_sleep", False)
    monkeypatch.delattr("mujoco.MjOption.sleep_tolerance", raising=False)  # neither can it be asked for
    tin = {
        "name": "tin",
        "parts": [{"shape": "box", "size": [0.04] * 3}],
        "mass_kg": 0.2,
        "friction": 0.5,
        "x": 0,
        "y": 0.2,
    }
    trial = make_trial(objects=[*plain()["objects"], tin])
    model = world(trial, LIGHT | {"tin": PhysicalParameters(0.2, 0.5)}).models[0]
    assert not model.opt.enableflags


def test_threads_and_order_do_not_matter():
    trial = make_trial()
    plan = pushes(5)
    one, _ = world(trial).rollout(beside(trial), controls(plan))
    two, _ = world(trial, cfg=PlanningCfg(threads=2)).rollout(beside(trial), controls(plan[::-1]))
    assert np.array_equal(one.box_pos, two.box_pos[::-1])


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_one_that_diverges_leaves_the_others_alone(bad, threads, capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    trial = make_trial()
    plan = pushes(4)
    good, _ = world(trial).rollout(beside(trial), controls(plan))
    plan[1, 5:] = bad
    with np.errstate(invalid="ignore"):
        context, sane = world(trial, cfg=PlanningCfg(threads=threads)).rollout(beside(trial), controls(plan))
    assert sane.tolist() == [True, False, True, True]
    assert np.array_equal(context.box_pos[sane], good.box_pos[sane])
    assert np.isfinite(context.box_pos).all()
    assert np.array_equal(context.box_pos[1, :5], good.box_pos[1, :5])
    assert np.array_equal(context.box_pos[1, 5:], np.repeat(good.box_pos[1, 4:5], 7, axis=0))
    assert capfd.readouterr() == ("", "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("box", [body(velocity=(-20.0, 0, 0)), body(velocity=(1e12, 0, 0)), body((np.nan, 0, 0))])
def test_nothing_holds_from_a_mad_state(box):
    trial = make_trial()
    context, sane = world(trial).rollout(seen(trial, box=box), controls(pushes()))
    assert not sane.any()
    assert np.isfinite(context.box_pos).all()


def test_starts_exactly_from_what_is_measured():
    trial = make_trial()
    planner = world(trial)
    box = body((0.05, -0.1, 0.4), (20, 30, 40), (0.1, 0.2, 0.3), (1.0, -2.0, 0.5))
    now = seen(trial, box=box)
    initial = planner._initial(now)
    index = planner._index
    qpos, qvel = initial[1 : 1 + index.nq], initial[1 + index.nq : 1 + index.nq + index.nv]
    assert np.array_equal(qpos[index.pose["box"]][:3], box.position)
    assert np.array_equal(qpos[index.pose["box"]][3:], box.quaternion)
    planner.rollout(beside(trial), controls(pushes()))
    assert np.array_equal(planner._initial(now), initial)
    planner.believe(HEAVY)
    assert np.array_equal(planner._initial(now), initial)
    assert np.array_equal(qvel[index.speed["box"]][:3], box.velocity)
    # A free turn goes on: the spin is read back in the world's axes.
    context, _ = planner.rollout(now, controls(np.full((1, 1, 3), now.tool.position)))
    assert context.box_angvel[0, 0] == pytest.approx(box.angular_velocity, rel=0.02)
    assert context.box_vel[0, 0] == pytest.approx([0.1, 0.2, 0.3 - 9.81 * CFG.step_s], abs=2e-3)


def test_what_is_believed_is_felt():
    trial = make_trial()
    sliding = seen(trial, box=body(velocity=(0.6, 0, 0)))
    still = controls(np.full((1, 20, 3), sliding.tool.position))
    planner = world(trial)
    ways = []
    for belief in (LIGHT, HEAVY):
        planner.believe(belief)
        context, _ = planner.rollout(sliding, still)
        ways.append(context.box_pos[0, -1, 0])
        assert context.box_mass[0, 0] == belief["box"].mass_kg
    assert ways[0] == pytest.approx(0.6**2 / (2 * 9.81 * 0.3), rel=0.15)
    assert ways[1] == pytest.approx(0.6**2 / (2 * 9.81 * 0.6), rel=0.15)


def test_a_heavier_box_is_pushed_less_far():
    trial = make_trial()
    far = []
    for mass in (0.1, 4.0):
        planner = world(trial, {"box": PhysicalParameters(mass, 0.5)})
        context, _ = planner.rollout(beside(trial), controls(pushes(1, 25), stiffness=200.0))
        far.append(context.box_pos[0, -1, 0])
    assert far[1] < far[0] - 0.005


def test_several_beliefs_are_rolled_out_side_by_side():
    trial = make_trial()
    plan = pushes(3)
    both, sane = world(trial, [LIGHT, HEAVY]).rollout(beside(trial), controls(plan))
    assert both.shape == (6, 12)
    assert sane.shape == (6,)
    for k, belief in enumerate((LIGHT, HEAVY)):
        alone, _ = world(trial, belief).rollout(beside(trial), controls(plan))
        rows = slice(3 * k, 3 * k + 3)
        assert np.array_equal(both.box_pos[rows], alone.box_pos)
        assert both.box_mass[rows, 0] == pytest.approx(belief["box"].mass_kg)
        assert np.array_equal(both.last_action[rows], alone.last_action)


def test_the_present_is_one_state_however_many_beliefs():
    trial = make_trial()
    planner = world(trial, [LIGHT, HEAVY])
    assert planner.present(beside(trial)).box_pos.shape == (1, 1, 3)


def test_every_quantity_is_there_in_its_shape():
    two = [plain()["objects"][0], plain()["objects"][0] | {"name": "tin", "x": -0.2}]
    trial = make_trial(objects=two)
    beliefs = {"box": PhysicalParameters(0.2, 0.5), "tin": PhysicalParameters(0.2, 0.5)}
    planner = world(trial, beliefs)
    context, _ = planner.rollout(beside(trial), controls(pushes()))
    assert context.names() == sorted(planner.schema)
    for name, quantity in planner.schema.items():
        shape = () if quantity.size == 0 else (quantity.size,)
        np.broadcast_to(context[name], (3, 12, *shape))
        assert context[name].shape[2:] == shape, name
        if quantity.constant:
            assert context[name].shape[1] == 1, name
        if quantity.truth:
            assert np.isin(context[name], (0, 1)).all(), name


def test_contacts_are_read():
    trial = make_trial()
    context, _ = world(trial).rollout(beside(trial), controls(pushes(1, 20)))
    assert context.box_table_contact[0, :10].all()
    assert not context.box_wall_contact.any()
    assert not context.box_hand_contact[0, 0]
    assert context.box_hand_contact[0, -8:].any()
    touched = context.box_hand_contact[0] > 0
    assert context.box_hand_force[0, touched, 0].max() > 0.5  # towards +x, on the box
    assert context.ee_force[0, touched, 0].min() < -0.5  # and back on the hand
    assert not context.box_hand_force[0, ~touched].any()


def test_force_and_torque_on_the_hand_are_those_of_its_contacts():
    trial = make_trial()
    planner, now, plan = world(trial), beside(trial), controls(pushes(1, 20))
    planner.edges = True  # the same model for both
    context, _ = planner.rollout(now, plan)
    model, data = planner.models[0], mujoco.MjData(planner.models[0])
    set_stiffness(model, CFG.hand, plan.stiffness)
    mujoco.mj_setState(model, data, planner._initial(now), mujoco.mjtState.mjSTATE_FULLPHYSICS)
    ours, seen_torque, one = {model.body(name).id for name in ("hand", "left", "right")}, 0.0, np.zeros(6)
    for step in range(20):
        data.ctrl[:2] = plan.opening[0, step] / 2
        data.mocap_pos[0], data.mocap_quat[0] = plan.position[0, step], plan.quaternion[0, step]
        for _ in range(round(CFG.step_s / CFG.physics_dt_s)):
            mujoco.mj_step(model, data)
        force, torque = np.zeros(3), np.zeros(3)
        for k, contact in enumerate(data.contact):
            bodies = [int(model.geom_bodyid[geom]) for geom in contact.geom]
            sign = (bodies[1] in ours) - (bodies[0] in ours)  # MuJoCo's is the force on the second
            mujoco.mj_contactForce(model, data, k, one)
            frame = contact.frame.reshape(3, 3).T
            force += sign * frame @ one[:3]
            torque += sign * (frame @ one[3:] + np.cross(contact.pos - context.ee_pos[0, step], frame @ one[:3]))
        assert context.ee_force[0, step] == pytest.approx(force, abs=1e-6)
        assert context.ee_torque[0, step] == pytest.approx(torque, abs=1e-6)
        seen_torque = max(seen_torque, float(np.linalg.norm(torque)))
    assert seen_torque > 0.05  # something was felt at all


def test_clock_and_actions():
    trial = make_trial()
    plan = np.tile([0, 0, 0.3], (1, 3, 1))
    plan[0, 2] += [0.01, 0, 0]
    context, _ = world(trial).rollout(seen(trial), controls(plan), step=7)
    assert context.time[0] == pytest.approx([0.02, 0.04, 0.06])
    assert context.current_step[0] == pytest.approx([8, 9, 10])
    assert context.last_action[0, :, 0] == pytest.approx([0, 0, 0.5])


def test_the_present_is_a_batch_of_one():
    trial = make_trial()
    assert world(trial).present(seen(trial)).shape == (1, 1)


def test_a_light_box_held_still_stays_between_the_fingers():
    # Askew by half a degree and a millimetre, as it is seen in a camera's pictures.
    trial, rng = make_trial(), np.random.default_rng(0)
    planner = world(trial)
    still = controls(np.tile([0.0, 0.0, 0.305], (1, 50, 1)), opening=-0.03)
    for _ in range(10):
        box = body(rng.normal([0.0, 0.0, 0.3], 0.001), rng.normal(scale=0.6, size=3))
        context, _ = planner.rollout(seen(trial, tool=(0.0, 0.0, 0.305), opening_m=0.0595, box=box), still)
        assert np.linalg.norm(context.box_pos[0, -1] - context.ee_pos[0, -1]) < 0.02


def test_a_drawer_is_rolled_out_along_its_slide_and_sleeps_until_it_is_touched():
    slide = {"kind": "slide", "axis": [1, 0, 0], "range": [-0.1, 0.1], "friction": 0.5}
    drawer = plain()["objects"][0] | {"joint": slide}
    tin = plain()["objects"][0] | {"name": "tin", "y": 0.2}
    trial = make_trial(objects=[drawer, tin])
    beliefs = {name: PhysicalParameters(0.2, 0.4) for name in ("box", "tin")}
    planner = world(trial, beliefs)
    away = np.broadcast_to([-0.2, 0.0, 0.03], (1, 12, 3))
    context, sane = planner.rollout(beside(trial), controls(np.concatenate([pushes(1), away])))
    assert sane.all()
    assert context.box_pos[0, -1, 0] > 0.005
    assert context.box_vel[0, -1, 0] > 0.01
    assert np.abs(context.box_pos[0, :, 1:] - [0.0, 0.03]).max() < 1e-6
    assert context.box_corner_pos[0] == pytest.approx(context.box_pos[0] + [0.03, 0.03, 0.03])
    assert np.abs(context.box_pos[1]).max() == pytest.approx(0.03, abs=1e-6)
    assert np.abs(context.box_angvel).max() < 1e-6


def test_a_drawers_slide_is_where_it_was_first_seen():
    slide = {"kind": "slide", "axis": [1, 0, 0], "range": [-0.1, 0.1]}
    trial = make_trial(objects=[plain()["objects"][0] | {"joint": slide}])
    first = seen(trial, box=body((0.0, 0.01, 0.03)))
    planner = PlanningWorld(trial, LIGHT, first, CFG)
    moved = replace(first, objects={"box": body((0.04, 0.02, 0.03))})
    assert planner.present(moved).box_pos[0, 0] == pytest.approx([0.04, 0.01, 0.03], abs=1e-4)


@pytest.mark.parametrize(("task", "unit"), [("close-drawer", 1.0), ("open-door", 180 / np.pi)])
def test_a_cost_reads_where_a_joint_stands_as_the_task_counts_it(scene, task, unit):
    one = scene(task)
    (name,) = one.trial.objects
    state = one.world.present(one.now)
    expected = unit * one.trial.joint_position(name, one.now.objects[name])
    assert state[f"{name}_joint"][0, 0] == pytest.approx(expected, abs=0.01 * unit)
    assert abs(expected) > 0.05 * unit
    assert one.world.schema[f"{name}_joint"].unit == ("m" if unit == 1.0 else "deg")


def test_a_stage_begins_now_unless_it_is_told_when():
    trial = make_trial()
    began = seen(trial, tool=(0.1, 0.0, 0.2), box=body((0.02, 0.0, 0.03), (0, 0, 30)))
    now = replace(seen(trial), time_s=3.0)
    plan = controls(np.tile([0, 0, 0.3], (1, 3, 1)))
    planner = world(trial)
    alone, _ = planner.rollout(now, plan)
    assert alone.stage_time[0] == pytest.approx([0.02, 0.04, 0.06])
    assert alone.box_stage_pos[0, 0] == pytest.approx(now.objects["box"].position)
    context, _ = planner.rollout(now, plan, since=replace(began, time_s=2.0))
    assert context.stage_time[0] == pytest.approx([1.02, 1.04, 1.06])
    assert context.ee_stage_pos[0, 0] == pytest.approx([0.1, 0.0, 0.2])
    assert context.box_stage_pos[0, 0] == pytest.approx([0.02, 0.0, 0.03])
    assert context.box_stage_quat[0, 0] == pytest.approx(began.objects["box"].quaternion)
    assert context.box_init_pos[0, 0] == pytest.approx(planner._start.objects["box"].position)


def test_fingers_pressed_on_the_table_touch_it_and_the_palm_does_not():
    trial = make_trial()
    now = seen(trial, tool=(-0.15, -0.15, 0.012), opening_m=0.02)
    down = controls(np.tile([-0.15, -0.15, -0.03], (1, 12, 1)))
    context, _ = world(trial).rollout(now, down)
    assert context.table_hand_contact[0, -1]
    assert not context.table_palm_contact.any()
    assert context.table_hand_force[0, -1, 2] < -5.0  # the hand pushes down
    assert context.table_hand_force[0, -1, 2] == pytest.approx(-context.ee_force[0, -1, 2], rel=1e-6)
    assert context.table_hand_clearance[0, -1] == 0.0
    assert not context.wall_hand_contact.any()


def test_a_palm_pressed_on_the_wall_touches_it():
    trial = make_trial()
    level = np.array([np.sqrt(0.5), 0.0, -np.sqrt(0.5), 0.0])  # the fingers point away from the wall
    now = seen(trial, tool=(0.14, 0.0, 0.3), opening_m=0.02)
    now = replace(now, tool=replace(now.tool, quaternion=level, position=np.array([0.12, 0.0, 0.15])))
    toward = controls(np.tile([0.17, 0.0, 0.15], (1, 25, 1)), quaternion=level)
    context, _ = world(trial).rollout(now, toward)
    assert context.wall_palm_contact[0, -1]
    assert context.wall_hand_contact[0, -1]

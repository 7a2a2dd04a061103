"""The simulated scene: masses, frictions, shapes and what the hand feels."""

import mujoco
import numpy as np
import pytest
from contact_bench import make_trial, plain

from coral.contact.control.hand_model import FINGER_FRICTION, HandCfg
from coral.contact.control.planning_model import build_model
from coral.contact.scene.geometry import from_rotvec, rotation_of
from coral.contact.scene.mujoco_scene import TABLE_COLOR, add_scene, geom_gap
from coral.contact.scene.observation import HandTarget
from coral.contact.scene.task_names import every_task
from coral.contact.scene.trial import PhysicalParameters, stated_beliefs, with_beliefs
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld
from coral.contact.worlds.robot_world import WorldError

TABLE, FINGER = np.array([0.4, 0.4, 0.025]), np.array([0.006, 0.002, 0.022])
XML = """<mujoco><worldbody><geom type="box" size=".4 .4 .025"/>
<body><freejoint/><geom type="box" size=".006 .002 .022"/></body></worldbody></mujoco>"""


def scene(trial):
    spec = mujoco.MjSpec()
    spec.option.timestep = 0.005
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10
    add_scene(spec, trial)
    return spec


def test_mass_is_shared_by_volume():
    parts = [{"size": [0.02, 0.02, 0.04]}, {"shape": "cylinder", "size": [0.02, 0.02, 0.02], "position": [0, 0, 0.05]}]
    model = scene(make_trial(objects=[plain()["objects"][0] | {"parts": parts, "mass_kg": 0.3}])).compile()
    body_id = model.body("box").id
    assert model.body_mass[body_id] == pytest.approx(0.3)
    share = 2 / (2 + np.pi / 4)
    assert model.body_ipos[body_id][2] == pytest.approx((1 - share) * 0.05)


@pytest.mark.parametrize(("friction", "slope", "slides"), [(0.3, 0.25, False), (0.3, 0.36, True), (0.8, 0.7, False)])
def test_the_objects_friction_holds_against_the_table(friction, slope, slides):
    trial = make_trial(objects=[plain()["objects"][0] | {"friction": friction}], fixtures=[])
    spec = scene(trial)
    spec.option.gravity = [9.81 * slope, 0, -9.81]
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 100)
    assert (data.body("box").xpos[0] > 0.03) is np.bool_(slides)


def test_between_pad_and_object_the_pads_friction_holds():
    trial = with_beliefs(make_trial(), {"box": PhysicalParameters(0.2, 0.1)})
    model = build_model(trial, HandCfg(), 0.01)
    data = mujoco.MjData(model)
    data.joint("hand_x").qpos[0], data.joint("hand_z").qpos[0] = 0.0, 0.03
    data.qpos[3:7] = [0, 1, 0, 0]
    mujoco.mj_fwdPosition(model, data)
    pairs = {}
    for contact in data.contact:
        names = sorted(model.geom(geom).name for geom in contact.geom)
        pairs[tuple(names)] = contact.friction[0]
    assert pairs["box/0", "left_finger"] == pytest.approx(FINGER_FRICTION)
    assert pairs["box/0", "table"] == pytest.approx(0.1)


def test_prior_is_the_middle_and_belief_leaves_the_truth_alone():
    trial = make_trial(objects=[plain()["objects"][0] | {"mass_kg": [0.1, 0.5], "friction": [0.2, 0.4]}])
    assert stated_beliefs(trial)["box"] == PhysicalParameters(pytest.approx(0.3), pytest.approx(0.3))
    believed = with_beliefs(trial, {"box": PhysicalParameters(9, 1)})
    assert believed.objects["box"].physical.mass_kg == 9
    assert believed.objects["box"].pose is trial.objects["box"].pose
    assert trial.objects["box"].physical.mass_kg < 1


def hand_world(**changes):
    far = plain()["objects"][0] | {"x": -0.35, "y": -0.35}
    return HandWorld(make_trial(objects=[far], fixtures=[], **changes))


def pulled(world, target, steps=100):
    observed = world.reset()
    for _ in range(steps):
        observed = world.step(target)
    return observed


@pytest.mark.parametrize(
    "turn", [(0, 0, 0), (np.radians(170), 0, 0), (0, np.radians(-170), 0), (0, 0, np.radians(170)), (1.0, -1.2, 0.7)]
)
def test_the_tool_comes_to_its_target_at_any_orientation(turn):
    turned = from_rotvec(turn)
    start = np.array([0.0, 1.0, 0.0, 0.0])
    w, x, y, z = start
    target = np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]) @ turned
    found = pulled(hand_world(), HandTarget(np.array([0.1, 0.1, 0.4]), target, 0.03, 600.0))
    assert found.tool.position == pytest.approx([0.1, 0.1, 0.4], abs=1e-3)
    assert abs(found.tool.quaternion @ target) == pytest.approx(1.0, abs=1e-4)
    assert found.opening_m == pytest.approx(0.03, abs=2e-3)


@pytest.mark.parametrize(("stiffness", "depth"), [(300.0, 0.02), (600.0, 0.02), (600.0, 0.04)])
def test_pressed_on_a_fixed_block_the_hand_pushes_with_stiffness_times_depth(stiffness, depth):
    down = np.array([0.0, 1.0, 0.0, 0.0])
    # The fingertips reach 8 mm beyond the tool.
    found = pulled(hand_world(), HandTarget(np.array([-0.1, 0.0, 0.008 - depth]), down, 0.02, stiffness), 150)
    pressed = stiffness * (found.tool.position[2] - (0.008 - depth))
    assert found.wrench[2] == pytest.approx(pressed, rel=0.02)
    assert found.wrench[2] == pytest.approx(stiffness * depth, rel=0.1)


def test_force_is_pushed_in_world_axes_whichever_way_the_hand_points():
    down = np.array([0.0, 1.0, 0.0, 0.0])
    target = HandTarget(np.array([0.0, 0.0, 0.3]), down, 0.04, 500.0, np.array([5.0, 0.0, -10.0]))
    assert pulled(hand_world(), target).tool.position == pytest.approx([0.01, 0.0, 0.28], abs=1e-3)


def test_contacts_say_which_way_the_force_goes():
    world = HandWorld(make_trial())
    world.reset()
    world.step(HandTarget(np.array([-0.1, 0, 0.25]), np.array([0.0, 1.0, 0, 0]), 0.08, 600.0))
    for _ in range(10):
        world.step(HandTarget(np.array([-0.1, 0, 0.25]), np.array([0.0, 1.0, 0, 0]), 0.08, 600.0))
    [contact] = world.truth().contacts
    assert (contact.first, contact.second) == ("box", "table")
    assert contact.force == pytest.approx([0, 0, -0.2 * 9.81], abs=1e-2)  # of the box on the table
    assert contact.point == pytest.approx([0, 0, 0], abs=2e-3)


def test_a_world_that_diverges_says_so():
    world = HandWorld(make_trial())
    world.reset()
    world.data.joint("box_free").qvel[:] = 1e12
    with pytest.raises(WorldError) as caught:
        world.step(HandTarget(np.array([-0.1, 0, 0.25]), np.array([0.0, 1.0, 0, 0]), 0.08, 600.0))
    assert caught.value.code == "diverged"


def test_reset_begins_the_same_trial_bit_for_bit():
    world = HandWorld(make_trial())
    target = HandTarget(np.array([0.0, 0, 0.03]), np.array([0.0, 1.0, 0, 0]), 0.08, 600.0)
    ends = []
    for _ in range(2):
        world.reset()
        for _ in range(30):
            ends.append(world.step(target).objects["box"].position)
    assert np.array_equal(ends[29], ends[59])


def test_a_mark_and_the_colour_of_a_part_are_seen_and_touch_nothing():
    parts = [{**plain()["objects"][0]["parts"][0], "color": [0.8, 0.2, 0.2]}]
    mark = {"place": "spot", "size": [0.1, 0.05], "color": [0.2, 0.6, 0.2]}
    trial = make_trial(objects=[plain()["objects"][0] | {"parts": parts}], places={"spot": [0.1, 0, 0]}, marks=[mark])
    spec = mujoco.MjSpec()
    add_scene(spec, trial)
    model = spec.compile()
    found = model.geom("mark/spot")
    assert (found.contype[0], found.conaffinity[0], found.group[0]) == (0, 0, 1)
    assert found.rgba[:3] == pytest.approx([0.2, 0.6, 0.2])
    assert model.geom("box/0").rgba[:3] == pytest.approx([0.8, 0.2, 0.2])


@pytest.mark.parametrize("name", every_task())
def test_fixtures_and_marks_are_told_from_the_table_by_their_colour(name):
    task = load_task(name)
    for one in (*task.fixtures, *task.marks):
        assert np.linalg.norm(np.subtract(one.color, TABLE_COLOR)) > 0.2, one


@pytest.fixture(scope="module")
def boxes():
    model = mujoco.MjModel.from_xml_string(XML)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, data


def place(data, position, turn):
    data.geom_xpos[1], data.geom_xmat[1] = position, rotation_of(from_rotvec(turn)).reshape(9)


def distance_by_projections(position, turn):
    rotation, point = rotation_of(from_rotvec(turn)), np.array(position)
    for _ in range(20_000):
        other = np.clip(point, -TABLE, TABLE)
        before, point = point, position + rotation @ np.clip(rotation.T @ (other - position), -FINGER, FINGER)
        if np.linalg.norm(point - before) < 1e-12:
            break
    return np.linalg.norm(point - np.clip(point, -TABLE, TABLE))


def test_it_finds_the_distance_where_mujoco_does_not(boxes):
    model, data = boxes
    rng = np.random.default_rng(0)
    fooled = 0
    for _ in range(150):
        position, turn = rng.uniform([-0.5, -0.5, 0.06], [0.5, 0.5, 0.2]), rng.uniform(-2, 2, 3) * rng.integers(0, 2)
        place(data, position, turn)
        fooled += mujoco.mj_geomDistance(model, data, 1, 0, 1.0, None) < 1e-3
        distance, start, end = geom_gap(model, data, 1, 0, 1.0)
        assert distance == pytest.approx(distance_by_projections(position, turn), abs=2e-5)
        assert np.linalg.norm(end - start) == pytest.approx(distance, abs=1e-5)
        assert data.geom_xmat[1] == pytest.approx(rotation_of(from_rotvec(turn)).reshape(9))
    assert fooled > 0, "MuJoCo is right now: the second try is no longer needed"


def test_overlapping_boxes_have_a_negative_distance(boxes):
    model, data = boxes
    place(data, [0.0, 0.0, 0.04], np.zeros(3))
    assert geom_gap(model, data, 1, 0, 1.0)[0] == pytest.approx(-0.007, abs=1e-5)


def test_far_boxes_are_as_far_as_was_asked(boxes):
    model, data = boxes
    place(data, [0.0, 0.0, 0.5], np.zeros(3))
    assert geom_gap(model, data, 1, 0, 0.05)[0] == 0.05

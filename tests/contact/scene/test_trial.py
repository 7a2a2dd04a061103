"""Trials: the same for the same seed, within the ranges, with nothing inside anything."""

import dataclasses

import mujoco
import numpy as np
import pytest
from contact_bench import body, changed, make_trial, plain
from hypothesis import given, settings
from hypothesis import strategies as st

from coral.contact.control.hand_model import HandCfg
from coral.contact.control.planning_model import Index, build_model
from coral.contact.control.planning_world import put_state
from coral.contact.scene.geometry import rotation_of
from coral.contact.scene.observation import BodyState, HandTarget, Observation
from coral.contact.scene.shapes import Joint, Shape
from coral.contact.scene.task import Task
from coral.contact.scene.task_names import shipped_tasks
from coral.contact.scene.trial import (
    FRICTION,
    joint_axis,
    joint_motion,
    joint_speed,
    move_joint,
    part_scale,
    prior_beliefs,
    sample_trial,
    stated_beliefs,
)
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld
from coral.errors import InputError

RANGES = plain()["objects"][0] | {
    "mass_kg": [0.1, 0.4],
    "friction": [0.3, 0.7],
    "x": [-0.2, 0.1],
    "y": [-0.1, 0.2],
    "yaw_deg": [-90, 90],
    "scale": [[0.5, 1], [1, 1.5], [1, 2]],
}
HINGE = {"kind": "hinge", "axis": [0, 0, 2], "point": [-0.03, 0, 0], "range": [0, 100], "start": 20, "friction": 0.01}
SLIDE = {"kind": "slide", "axis": [0, 1, 0], "range": [-0.2, 0.1], "friction": 1.0}


def test_same_seed_same_trial_bit_for_bit():
    first, again, other = (make_trial(objects=[RANGES], seed=seed).objects["box"] for seed in (4, 4, 5))
    assert np.array_equal(first.pose.position, again.pose.position)
    assert np.array_equal(first.pose.quaternion, again.pose.quaternion)
    assert first.physical == again.physical
    assert first.physical != other.physical


def test_tasks_of_other_names_are_drawn_otherwise():
    first, second = (make_trial(objects=[RANGES], name=name).objects["box"].physical for name in ("bench", "other"))
    assert first != second


@settings(max_examples=30, deadline=None, derandomize=True)
@given(st.integers(0, 10**6))
def test_values_lie_in_their_ranges_and_objects_on_the_table(seed):
    trial = make_trial(objects=[RANGES], seed=seed)
    box = trial.objects["box"]
    assert 0.1 <= box.physical.mass_kg <= 0.4
    assert 0.3 <= box.physical.friction <= 0.7
    assert -0.2 <= box.pose.position[0] <= 0.1
    assert -0.1 <= box.pose.position[1] <= 0.2
    assert np.all(box.scale >= [0.5, 1, 1])
    assert np.all(box.scale <= [1, 1.5, 2])
    assert trial.lowest_point("box", box.pose) == pytest.approx(0, abs=1e-12)
    assert trial.size("box") == pytest.approx(0.06 * box.scale)


@pytest.mark.parametrize("name", shipped_tasks())
def test_objects_keep_a_centimetre_apart(name):
    task = load_task(name)
    for seed in range(10):
        trial = sample_trial(task, seed)
        boxes = []
        for key, item in trial.objects.items():
            placed = trial.corners(key) @ rotation_of(item.pose.quaternion).T + item.pose.position
            boxes.append((placed.min(axis=0), placed.max(axis=0)))
        for k, (low, high) in enumerate(boxes):
            for other_low, other_high in boxes[k + 1 :]:
                assert np.maximum(other_low - high, low - other_high).max() >= 0.01 - 1e-9


def test_two_objects_in_one_place_are_refused():
    box = plain()["objects"][0]
    with pytest.raises(InputError, match="box and other in each other's place"):
        make_trial(objects=[box, box | {"name": "other", "x": 0.065}])


@pytest.mark.parametrize(
    ("x", "z", "fits"),
    [(0.2, None, True), (0.199, None, True), (0.203, None, False), (0.25, 0.23, True), (0.25, None, False)],
)
def test_objects_stand_against_or_on_a_fixture_but_not_in_it(x, z, fits):
    box = plain()["objects"][0] | {"x": x} | ({} if z is None else {"z": z})
    if fits:
        make_trial(objects=[box])
    else:
        with pytest.raises(InputError, match="box and wall"):
            make_trial(objects=[box])


def test_a_slanted_wall_leaves_the_room_beside_it():
    wall = plain()["fixtures"][0] | {"yaw_deg": 45, "position": [0.15, 0, 0.1]}
    make_trial(
        fixtures=[wall], objects=[plain()["objects"][0] | {"x": 0.1, "y": 0.15}]
    )  # inside the wall's upright box
    with pytest.raises(InputError):
        make_trial(fixtures=[wall], objects=[plain()["objects"][0] | {"x": 0.15}])


def test_laid_on_its_side():
    trial = make_trial(
        objects=[plain()["objects"][0] | {"parts": [{"size": [0.02, 0.04, 0.1]}], "rpy_deg": [90, 0, 0]}]
    )
    assert trial.objects["box"].pose.position[2] == pytest.approx(0.02)


def test_named_points_and_the_lowest_point_follow_the_object():
    trial = make_trial(objects=[plain()["objects"][0] | {"scale": [1, 2, 1]}])
    pose = body((1, 0, 0.5), (0, 0, 90))
    assert trial.point("box", "corner", pose) == pytest.approx([1 - 0.06, 0.03, 0.53])
    assert trial.lowest_point("box", body((0, 0, 0.5), (0, 45, 0))) == pytest.approx(0.5 - 0.03 * np.sqrt(2))


@pytest.mark.parametrize(
    ("shape", "rpy", "expected"),
    [
        ("box", (0, 0, 0), (1, 2, 4)),
        ("box", (0, 0, 90), (2, 1, 4)),
        ("box", (90, 0, 0), (1, 4, 2)),
        ("cylinder", (0, 0, 0), (np.sqrt(2), np.sqrt(2), 4)),
        ("cylinder", (90, 0, 0), (2, 2, 2)),
        ("sphere", (0, 0, 0), (2, 2, 2)),
    ],
)
def test_a_turned_part_is_scaled_along_the_objects_axes(shape, rpy, expected):
    part = Shape(shape=shape, size=(0.1, 0.1, 0.1), rpy_deg=rpy)
    assert part_scale(part, np.array([1.0, 2.0, 4.0])) == pytest.approx(expected)


def test_an_even_scale_keeps_any_shape():
    part = Shape(size=(0.1, 0.2, 0.3), rpy_deg=(10, 20, 30))
    assert part_scale(part, np.full(3, 1.5)) == pytest.approx([1.5, 1.5, 1.5])


@pytest.mark.parametrize(
    ("part", "size"),
    [
        ({"shape": "cylinder", "size": [0.1, 0.1, 0.3]}, (0.1, 0.1, 0.3)),
        ({"shape": "sphere", "size": [0.1] * 3}, [0.1] * 3),
        ({"size": [0.1, 0.2, 0.3], "rpy_deg": [0, 0, 90]}, (0.2, 0.1, 0.3)),
    ],
)
def test_extents(part, size):
    trial = sample_trial(Task.model_validate(changed("objects.0.parts", [part])), 0)
    assert trial.size("box") == pytest.approx(size)


BASE = {
    "parts": [{"size": [0.08, 0.08, 0.04]}],
    "mass_kg": 0.3,
    "friction": 0.5,
    "name": "base",
    "x": [0, 0.1],
    "y": 0.1,
}


@pytest.mark.parametrize("order", [1, -1])
def test_a_stack_begins_in_contact_whichever_object_comes_first(order):
    top = plain()["objects"][0] | {"stands_on": "base", "x": [-0.01, 0.01]}
    trial = make_trial(objects=[top, BASE][::order])
    top, base = trial.objects["box"].pose.position, trial.objects["base"].pose.position
    assert top[2] == pytest.approx(0.04 + 0.03)
    assert np.abs((top - base)[:2]).max() <= 0.01
    assert list(trial.objects) == ["box", "base"][::order]


@pytest.mark.parametrize(("z", "fits"), [(0.07, True), (0.0695, True), (0.06, False)])
def test_a_height_of_ones_own_may_touch_but_not_penetrate(z, fits):
    objects = [plain()["objects"][0] | {"z": z}, BASE | {"x": 0, "y": 0}]
    if fits:
        assert make_trial(objects=objects).objects["box"].pose.position[2] == z
    else:
        with pytest.raises(InputError, match="box and base in each other's place"):
            make_trial(objects=objects)


def test_an_object_may_stand_in_the_hollow_of_another():
    ring = [{"size": [0.02, 0.12, 0.04], "position": [x, 0, 0]} for x in (-0.06, 0.06)]
    objects = [plain()["objects"][0] | {"z": 0.03}, BASE | {"parts": ring, "x": 0, "y": 0}]
    assert make_trial(objects=objects).objects["box"].pose.position[2] == 0.03


def test_a_joint_starts_where_its_range_says_and_may_be_built_into_a_fixture():
    slide = {"kind": "slide", "axis": [1, 0, 0], "range": [-0.3, 0], "start": [-0.2, -0.1]}
    trial = make_trial(objects=[plain()["objects"][0] | {"x": 0.25, "joint": slide}])
    start = trial.objects["box"].joint_start
    assert -0.2 <= start <= -0.1
    assert trial.objects["box"].pose.position[0] == pytest.approx(0.25 + start)


def test_what_is_only_seen_is_taken_for_the_same_stuff_whatever_the_task_states():
    trial = make_trial()
    held = prior_beliefs(trial)["box"]
    assert (held.mass_kg, held.friction) == (pytest.approx(500.0 * 0.06**3), FRICTION)
    (box,) = trial.task.objects
    other = trial.task.model_copy(update={"objects": (box.model_copy(update={"mass_kg": (3.0, 5.0)}),)})
    heavier = dataclasses.replace(trial, task=other)
    assert prior_beliefs(heavier)["box"] == held
    assert stated_beliefs(heavier)["box"].mass_kg == 4.0


def trial_on(joint, **more):
    return make_trial(objects=[plain()["objects"][0] | {"z": 0.1, "yaw_deg": 90, "joint": joint} | more])


def test_a_hinge_turns_about_its_point():
    joint, start = Joint.model_validate(HINGE), body((0, 0, 0.1))
    moved = move_joint(joint, start, np.radians(90))
    assert moved.position == pytest.approx([-0.03, 0.03, 0.1])
    assert np.degrees(joint_motion(joint, start, moved)) == pytest.approx(90)
    spinning = BodyState(moved.position, moved.quaternion, np.zeros(3), np.array([0.5, 0, 0.7]))
    assert joint_speed(joint, start, spinning) == pytest.approx(0.7)


def test_a_slide_moves_along_its_axis_in_the_objects_frame():
    joint, start = Joint.model_validate(SLIDE), body((0, 0, 0.1), (0, 0, 90))
    assert joint_axis(joint, start) == pytest.approx([-1, 0, 0])
    moved = move_joint(joint, start, 0.05)
    assert moved.position == pytest.approx([-0.05, 0, 0.1])
    assert joint_motion(
        joint, start, BodyState(moved.position + np.array([0, 0.3, 0]), moved.quaternion)
    ) == pytest.approx(0.05)


@pytest.mark.parametrize("joint", [HINGE, SLIDE])
def test_the_simulation_moves_an_object_as_the_joint_does(joint):
    trial = trial_on(joint)
    world = HandWorld(trial)
    first = world.reset().objects["box"]
    assert first.position == pytest.approx(trial.objects["box"].pose.position, abs=1e-6)
    held = trial.task.object("box").joint
    by = 0.05
    world.data.joint("box_joint").qpos[0] += by
    mujoco.mj_forward(world.model, world.data)
    now = world.truth().objects["box"]
    expected = move_joint(held, trial.objects["box"].pose, by)
    assert now.position == pytest.approx(expected.position, abs=1e-6)
    assert abs(now.quaternion @ expected.quaternion) == pytest.approx(1)
    assert trial.joint_position("box", now) == pytest.approx(trial.objects["box"].joint_start + by)


@pytest.mark.parametrize("joint", [HINGE, SLIDE])
def test_rollouts_start_from_the_measured_joint(joint):
    trial = trial_on(joint)
    model = build_model(trial, HandCfg(), 0.01)
    data = mujoco.MjData(model)
    held, start = trial.task.object("box").joint, trial.objects["box"].pose
    seen = move_joint(held, start, 0.04)
    tool = BodyState(np.array([0, 0, 0.4]), np.array([0.0, 1, 0, 0]))
    put_state(model, data, Observation(0.0, tool, 0.08, np.zeros(6), {"box": seen}), trial)
    mujoco.mj_forward(model, data)
    assert data.body("box").xpos == pytest.approx(seen.position, abs=1e-6)
    index = Index(model, ["box"])
    assert data.sensordata[index.sensor["box/pos"]] == pytest.approx(seen.position, abs=1e-6)
    assert len(index.speeds) == 1


def test_a_drawer_stays_where_its_friction_holds_it_and_stops_at_the_end_of_its_range():
    steep = SLIDE | {"axis": [0, 0, 1], "range": [-0.05, 0.0]}
    for friction, down in ((3.0, 0.0), (0.5, -0.05)):  # the box weighs 2 N
        trial = trial_on(steep | {"friction": friction})
        world = HandWorld(trial)
        now = world.reset()
        hold = HandTarget(now.tool.position, now.tool.quaternion, 0.08, 600.0)
        for _ in range(40):
            now = world.step(hold)
        assert trial.joint_position("box", now.objects["box"]) == pytest.approx(down, abs=0.004)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"axis": [0, 0, 0]}, "an axis, not all zero"),
        ({"range": [0, 171]}, "within -170 to 170"),
        ({"range": [10, 10]}, "not empty"),
        ({"start": 101}, "a start within the range"),
        ({"kind": "slide", "range": [0, 0.1], "start": 0}, "a point only with a hinge"),
    ],
)
def test_refuses(change, expected):
    with pytest.raises(ValueError, match=expected):
        Joint.model_validate(HINGE | change)

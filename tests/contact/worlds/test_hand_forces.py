"""The hand's force on an object in every physics step."""

import mujoco
import numpy as np
import pytest
from contact_bench import make_trial

from coral.contact.scene.observation import HandTarget
from coral.contact.worlds.hand_forces import HandForces, add_hand_force_sensors
from coral.contact.worlds.hand_world import DOWN, HandWorld


def two_balls(trial, height):
    """A ball as the hand, above another one that lies on the floor."""
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[1, 1, 1])
    for name, z in (("hand", height), ("box", 0.05)):
        ball = spec.worldbody.add_body(name=name, pos=[0, 0, z])
        ball.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, 0, 1])
        ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.05, 0, 0], mass=0.5)
    add_hand_force_sensors(spec, "hand", trial)
    model = spec.compile()
    data = mujoco.MjData(model)
    return model, data, HandForces(model, data, trial)


def test_at_rest_the_mean_is_the_weight_and_a_fall_peaks_above_it():
    model, data, forces = two_balls(make_trial(), 0.17)
    mujoco.mj_step(model, data)
    forces.add()
    assert forces.read()["box"].mean is None
    assert forces.read()["box"].peak == 0.0
    for _ in range(200):
        mujoco.mj_step(model, data)
        forces.add()
    assert forces.read()["box"].peak > 15
    mujoco.mj_step(model, data, 2000)
    forces.begin()
    for _ in range(5):
        mujoco.mj_step(model, data)
        forces.add()
    assert forces.read()["box"].mean == pytest.approx([0, 0, -0.5 * 9.81], abs=0.05)


def test_nothing_is_measured_before_the_first_physics_step():
    *_, forces = two_balls(make_trial(), 0.15)
    assert forces.read() == {}


def test_the_world_tells_the_judge_of_a_blow():
    world = HandWorld(make_trial())
    world.reset()
    assert world.truth().hand_forces == {}
    peaks = []
    for _ in range(40):  # down onto the box
        world.step(HandTarget(np.array([0.0, 0.0, 0.04]), DOWN, 0.0, 600.0))
        peaks.append(world.truth().hand_forces["box"].peak)
    assert peaks[0] == 0
    assert max(peaks) > 10

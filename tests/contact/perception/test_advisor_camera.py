import dataclasses

import cv2
import numpy as np
import pytest
from episodes import ObedientWorld, make_trial

from coral.contact.perception.advisor_camera import AdvisorCameraCfg, make_advisor_camera, to_picture
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.scene.observation import HandTarget
from coral.contact.scene.shapes import TableMark
from coral.contact.worlds.hand_world import HandWorld

SIZE = AdvisorCameraCfg(width=80, height=60)


@pytest.fixture
def world():
    world = HandWorld(make_trial())
    world.reset()
    return world


def camera(world, seed=0):
    return make_advisor_camera(world, make_trial(), TrackedCfg(), SIZE, np.random.default_rng(seed))


def test_a_picture_has_its_size_and_colours_and_shows_the_objects(world):
    frame = camera(world)()
    assert frame.rgb.shape == (60, 80, 3)
    assert frame.mask("box").any()


def test_a_mark_on_the_table_is_in_the_picture():
    plain, mark = make_trial(), TableMark(place="mat", size=(0.2, 0.2), color=(0.0, 1.0, 0.0))
    task = plain.task.model_copy(update={"places": {"mat": (0.1, 0.1, 0.02)}, "marks": (mark,)})
    trial = dataclasses.replace(plain, task=task)
    marked = HandWorld(trial)
    marked.reset()
    frame = make_advisor_camera(marked, trial, TrackedCfg(), SIZE, np.random.default_rng(0))()
    red, green, blue = frame.rgb.astype(int).transpose(2, 0, 1)
    assert ((green > 100) & (red < 50) & (blue < 50)).sum() > 5


def test_each_picture_shows_the_world_as_it_stands(world):
    look = camera(world)
    before = look()
    joint = world.simulation.model.joint("box_free")
    world.simulation.data.qpos[joint.qposadr[0]] += 0.1
    now = world.truth().tool
    world.step(HandTarget(now.position, now.quaternion, 0.08, 600.0))
    columns = [np.nonzero(frame.mask("box"))[1].mean() for frame in (before, look())]
    assert abs(columns[1] - columns[0]) > 3


def test_the_same_seed_takes_the_same_picture(world):
    first, again, other = (camera(world, seed)().depth for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()


def test_of_a_world_without_a_simulation_there_is_no_picture():
    assert camera(ObedientWorld(make_trial()))() is None


def test_a_question_gets_the_colours_as_they_are(world):
    frame = camera(world)()
    picture = to_picture(frame)
    assert picture.name == "scene"
    pixels = cv2.imdecode(np.frombuffer(picture.png, np.uint8), cv2.IMREAD_COLOR)
    np.testing.assert_array_equal(pixels[..., ::-1], frame.rgb)


def test_the_camera_above_sees_what_lies_ahead_higher_in_its_picture(world):
    look = make_advisor_camera(world, make_trial(), TrackedCfg(), SIZE, np.random.default_rng(0), above=True)
    before = look()
    world.simulation.data.qpos[world.simulation.model.joint("box_free").qposadr[0]] += 0.1
    now = world.truth().tool
    world.step(HandTarget(now.position, now.quaternion, 0.08, 600.0))
    rows = [np.nonzero(frame.mask("box"))[0].mean() for frame in (before, look())]
    assert rows[1] < rows[0] - 3

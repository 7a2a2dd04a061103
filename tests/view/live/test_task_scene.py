"""The solids and lines of a contact task's page."""

import numpy as np
import pytest

from coral.contact.control.rehearsed_paths import RehearsedPaths
from coral.contact.scene.observation import BodyState
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.view.live.task_scene import M_PER_N, TaskScene, lines

UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
DOWN = np.array([0.0, 1.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def scene():
    return TaskScene(sample_trial(load_task("flip-wall"), 0))


def bodies(scene, opening_m):
    tool = BodyState(np.array([0.1, 0.2, 0.3]), DOWN)
    box = BodyState(np.array([0.05, -0.1, 0.04]), UPRIGHT)
    return {body.name.rpartition("-")[0]: body for body in scene.bodies(tool, opening_m, {"box": box})}


def test_fingers_open_along_the_tools_y_axis(scene):
    shut, wide = bodies(scene, 0.0), bodies(scene, 0.06)
    apart = np.subtract(wide["left"].position, wide["right"].position)
    before = np.subtract(shut["left"].position, shut["right"].position)
    assert apart - before == pytest.approx([0.0, -0.06, 0.0])  # palm down: the tool's y axis points to -y


def test_objects_move_and_fixtures_stay(scene):
    found = bodies(scene, 0.05)
    assert found["box"].position[:2] == pytest.approx((0.05, -0.1), abs=0.05)
    wall = next(body for name, body in found.items() if name == "world")
    assert wall.parts[0].shape == "box"
    assert not any(part.size[0] > 0.7 for body in found.values() for part in body.parts)  # the table is the ground


def test_the_ground_is_the_table(scene):
    table = load_task("flip-wall").table
    height, width = scene.ground.cells.shape
    assert (width * scene.ground.cell_m, height * scene.ground.cell_m) == pytest.approx(table.size[:2])


def test_the_plan_its_rehearsals_and_the_force_are_lines():
    path = np.linspace([0, 0, 0], [0.1, 0, 0], 5)
    paths = RehearsedPaths(path, np.stack([path] * 3), {"box": path})
    made = {line.name: line for line in lines(path, path[-1], np.array([0.0, 0.0, 5.0]), paths)}
    assert {name: len(line.segments) for name, line in made.items()} == {
        "trail": 4,
        "tried": 12,
        "carried": 4,
        "plan": 4,
        "force": 1,
    }
    assert made["tried"].layer == "rollouts"
    assert made["force"].segments[0, 1] - made["force"].segments[0, 0] == pytest.approx([0, 0, 5 * M_PER_N])
    assert all(not len(line.segments) for line in lines(path[:1], path[0], np.zeros(3))[1:4])

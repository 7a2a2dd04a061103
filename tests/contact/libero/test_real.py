"""LIBERO-OBJECT as it really is (make test-libero)."""

import mujoco
import numpy as np
import pytest

from coral.contact.libero.package import SUITES, find_package
from coral.contact.scene.geometry import rotation_of
from coral.contact.scene.mujoco_scene import add_scene
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task

pytestmark = pytest.mark.libero


@pytest.mark.parametrize("suite", SUITES)
def test_ten_tasks(suite):
    assert len(find_package("test", suite).tasks()) == 10


@pytest.mark.parametrize("suite", SUITES)
@pytest.mark.parametrize("task", range(10))
def test_every_initial_state_is_a_trial_that_stands(suite, task):
    for state in (0, 17, 49):
        trial = sample_trial(load_task(f"libero:{suite}/{task}/{state}"), 0)
        spec = mujoco.MjSpec()
        spec.option.timestep = 0.002
        add_scene(spec, trial)
        model = spec.compile()
        data = mujoco.MjData(model)
        mujoco.mj_step(model, data, 500)
        for name, item in trial.objects.items():
            np.testing.assert_allclose(data.body(name).xpos, item.pose.position, atol=3e-3)
            assert rotation_of(data.body(name).xquat)[2, 2] > 0.999


def test_soup_and_basket():
    trial = sample_trial(load_task("libero:object/0"), 0)
    assert trial.task.objects[0].name == "alphabet_soup"
    np.testing.assert_allclose(trial.size("alphabet_soup"), [0.062, 0.062, 0.076], atol=1e-3)
    (condition,) = trial.task.success.conditions
    np.testing.assert_allclose(np.subtract(condition.high, condition.low), [0.122, 0.122, 0.149], atol=1e-3)

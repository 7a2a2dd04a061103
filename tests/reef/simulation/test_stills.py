import numpy as np
import pytest

from coral import plugins
from coral.errors import InputError
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.simulation.simulator import SimulatorCfg, make_stills
from coral.reef.simulation.stills import make_painter
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import find_water
from coral.reef.world.world import load_world


def test_a_still_is_taken_when_it_is_asked_for_and_always_the_same(small_stills):
    scene, cfg, pose = Scene.from_world(load_world("s1")), SimulatorCfg(), Pose(5.0, 5.0, 0.3)
    frame = Camera(scene, cfg.camera).render(pose)
    stills = make_stills(scene, cfg, 1)
    found = stills.of(frame, pose, 2.0)
    assert found.rgb is None
    assert found.still().shape == (240, 320, 3)
    assert np.array_equal(found.still(), stills.of(frame, pose, 2.0).still())
    assert not np.array_equal(found.still(), stills.of(frame, Pose(5.0, 5.0, 0.4), 2.0).still())


def test_it_paints_in_the_water_that_it_is_given(monkeypatch):
    scene, water = Scene.from_world(load_world("s1")), find_water("bay")
    assert make_painter(scene, CameraCfg(), water, PainterCfg(), 0).water is water
    monkeypatch.setitem(plugins.OURS, "painter", {"reef": "coral.no_such_wing:Painter"})
    with pytest.raises(InputError, match=r"--cfg.simulator.pictures: .*the wing coral.no_such_wing, which is not"):
        make_painter(scene, CameraCfg(), water, PainterCfg(), 0)

"""The painter of a simulated camera, which a wing may lack."""

import pytest

from coral import plugins
from coral.errors import InputError
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.simulation.frame_painter import make_painter
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import find_water
from coral.reef.world.world import load_world


def test_it_paints_in_the_water_that_it_is_given(monkeypatch):
    scene, water = Scene.from_world(load_world("s1")), find_water("bay")
    assert make_painter(scene, CameraCfg(), water, PainterCfg(), 0).water is water
    monkeypatch.setitem(plugins.OURS, "painter", {"reef": "coral.no_such_wing:Painter"})
    with pytest.raises(InputError, match=r"--cfg.simulator.pictures: .*the wing coral.no_such_wing, which is not"):
        make_painter(scene, CameraCfg(), water, PainterCfg(), 0)

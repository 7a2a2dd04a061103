import numpy as np

from coral.reef.simulation.simulator import SimulatorCfg, make_stills
from coral.reef.simulation.stills import STILL_PX
from coral.reef.vehicle.camera import Camera
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import load_world


def test_a_still_is_taken_when_it_is_asked_for_and_always_the_same():
    scene, cfg, pose = Scene.from_world(load_world("s1")), SimulatorCfg(), Pose(5.0, 5.0, 0.3)
    frame = Camera(scene, cfg.camera).render(pose)
    stills = make_stills(scene, cfg, 1)
    found = stills.of(frame, pose, 2.0)
    assert found.rgb is None
    assert found.still().shape == (STILL_PX[1], STILL_PX[0], 3)
    assert np.array_equal(found.still(), stills.of(frame, pose, 2.0).still())
    assert not np.array_equal(found.still(), stills.of(frame, Pose(5.0, 5.0, 0.4), 2.0).still())

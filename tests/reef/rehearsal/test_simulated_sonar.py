import numpy as np
from echoes import SMALL

from coral.reef.map.sonar_3d15 import Sonar3d15
from coral.reef.rehearsal.simulated_sonar import SimulatedSonar
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import load_world

SCENE = Scene.from_world(load_world("s1"))


class FakeClock:
    now = 0.0

    def __call__(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds


def sonar():
    return Sonar3d15(SCENE, SMALL, np.random.default_rng(0))


def test_it_hears_the_reef_from_where_the_vehicle_is_at_its_rate():
    clock, pose = FakeClock(), Pose(5.0, 5.0, 0.3)
    simulated = SimulatedSonar(sonar(), lambda: (clock.now, pose), 1.0, clock, clock.sleep)
    heard = [simulated.read() for _ in range(3)]
    assert [round(each.stamp_s, 6) for each in heard] == [0.0, 0.2, 0.4]
    assert np.array_equal(heard[0].image.ranges, sonar().image(pose, 1.0).ranges)


def test_without_a_pose_there_is_no_image():
    clock = FakeClock()
    assert SimulatedSonar(sonar(), lambda: None, 1.0, clock, clock.sleep).read() is None

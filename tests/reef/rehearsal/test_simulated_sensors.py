import numpy as np
from echoes import SMALL

from coral.reef.map.sonar_3d15 import Sonar3d15
from coral.reef.paint.painter import Painter
from coral.reef.rehearsal.simulated_sensors import simulated_camera, simulated_sonar
from coral.reef.simulation.noise import SensorNoise, SensorNoiseCfg
from coral.reef.simulation.simulator import SimulatorCfg, make_stills
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import load_world

SCENE = Scene.from_world(load_world("s1"))


class FakeClock:
    def __init__(self):
        self.now, self.timing = 0.0, {"clock": self, "sleep": self.sleep}

    def __call__(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds


def sonar():
    return Sonar3d15(SCENE, SMALL, np.random.default_rng(0))


def test_it_hears_the_reef_from_where_the_vehicle_is_at_its_rate():
    clock, pose = FakeClock(), Pose(5.0, 5.0, 0.3)
    simulated = simulated_sonar(sonar(), lambda: (clock.now, pose), 1.0, **clock.timing)
    heard = [simulated.read() for _ in range(3)]
    assert [round(each.t, 6) for each in heard] == [0.0, 0.2, 0.4]
    assert np.array_equal(heard[0].value.ranges, sonar().image(pose, 1.0).ranges)


def test_without_a_pose_there_is_no_image():
    clock = FakeClock()
    assert simulated_sonar(sonar(), lambda: None, 1.0, **clock.timing).read() is None


def test_the_camera_renders_where_the_vehicle_is_at_its_rate():
    scene, cfg, clock = Scene.from_world(load_world("s1")), CameraCfg(), FakeClock()
    pose = Pose(5.0, 5.0, 0.3)
    camera = simulated_camera(scene, cfg, lambda: (clock.now - 0.05, pose), 10.0, **clock.timing)
    shots = [camera.read() for _ in range(3)]
    assert [round(shot.stamp_s, 6) for shot in shots] == [-0.05, 0.05, 0.15]
    assert np.array_equal(shots[0].frame.depth, Camera(scene, cfg).render(pose).depth)


def test_without_a_pose_there_is_no_picture():
    clock = FakeClock()
    scene = Scene.from_world(load_world("s1"))
    assert simulated_camera(scene, CameraCfg(), lambda: None, 10.0, **clock.timing).read() is None


def test_it_takes_colours_with_a_painter():
    scene, cfg, clock = Scene.from_world(load_world("s1")), CameraCfg(width=40, height=30), FakeClock()
    pose, painter = Pose(5.0, 5.0, 0.3), Painter(scene, cfg, "bay", seed=1)
    camera = simulated_camera(scene, cfg, lambda: (100.0 + clock.now, pose), 10.0, painter=painter, **clock.timing)
    first, second = camera.read().frame, camera.read().frame
    assert np.array_equal(first.rgb, painter.paint(first, pose, t=0.0))
    assert not np.array_equal(first.rgb, second.rgb)


def test_noise_spoils_depth_and_classes_and_not_the_colours():
    scene, cfg, clock = Scene.from_world(load_world("s1")), CameraCfg(width=40, height=30), FakeClock()
    noise = SensorNoise(SensorNoiseCfg(dropout=1.0), np.random.default_rng(0), cfg)
    painter = Painter(scene, cfg, "bay", seed=1)
    where = lambda: (100.0, Pose(5.0, 5.0, 0.3))  # noqa: E731
    camera = simulated_camera(scene, cfg, where, 10.0, painter=painter, noise=noise, **clock.timing)
    frame = camera.read().frame
    assert np.isinf(frame.depth).all()
    assert frame.rgb.std() > 1.0


def test_questions_get_stills():
    clock, cfg = FakeClock(), SimulatorCfg(stills=True)
    scene = Scene.from_world(load_world("s1"))
    where = lambda: (100.0, Pose(5.0, 5.0, 0.3))  # noqa: E731
    camera = simulated_camera(scene, cfg.camera, where, 10.0, stills=make_stills(scene, cfg, 1), **clock.timing)
    frame = camera.read().frame
    assert frame.rgb is None
    assert frame.still().shape[:2] == (960, 1280)

import numpy as np

from coral.reef.map.echo_points import echoes_in_picture
from coral.reef.map.sonar_3d15 import Sonar3d15, SonarCfg
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

OYSTER = Oyster(x=9.0, y=9.0, z=0.03, radii=(0.1, 0.1, 0.05))
WORLD = ReefWorld(
    name="post",
    size_m=(10.0, 10.0),
    start=Start(x=2.0, y=5.0, theta=0.0),
    clusters=(Cluster(name="a", oysters=(OYSTER,)),),
    obstacles=(Obstacle(shape="box", x=5.0, y=5.0, z=1.0, size=(0.3, 0.6, 1.0)),),
)


def test_echoes_have_the_depth_that_the_camera_has_there():
    scene, camera = Scene.from_world(WORLD), CameraCfg()
    cfg = SonarCfg(enabled=True, sigma_m=0, sigma_share=0, dropout=0, multipath=0, grazing_deg=0, resolution_m=0)
    image = Sonar3d15(scene, cfg, np.random.default_rng(0)).image(Pose(2.0, 5.0, 0.1), 1.0)
    points = echoes_in_picture(image, cfg.pitch_down_deg, camera)
    depth = Camera(scene, camera).render(Pose(2.0, 5.0, 0.1)).depth
    at = np.round(points[:, :2]).astype(int)
    there = depth[at[:, 1], at[:, 0]]
    near = np.isfinite(there) & (points[:, 2] < 4.0)
    assert near.sum() > 5000
    # Half a pixel beside an edge, the camera sees something else.
    assert np.mean(np.abs(there[near] / points[near, 2] - 1.0) < 0.03) > 0.95


def test_what_is_not_heard_or_not_in_view_is_no_point():
    image = RangeImage(np.array([[np.inf, 2.0], [np.inf, np.inf]], np.float32), 170.0, 10.0)
    assert echoes_in_picture(image, 0.0, CameraCfg(hfov_deg=60.0)).shape == (0, 3)

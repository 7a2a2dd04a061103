"""A run folder with keyframes of a small reef, made without driving a mission."""

import math
from dataclasses import replace

import numpy as np
import yaml

from coral.config import to_mapping
from coral.reef.map.mapping import MapCfg, OccupancyMap
from coral.reef.mission.record import COLUMNS, FrameRecorder, PicturePose, RecordCfg
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start, save_world
from coral.runs import RunWriter

CAMERA = CameraCfg(width=80, height=60)


def patch() -> ReefWorld:
    """Sixty oysters about (5, 4) and a post, in 9 x 8 m."""
    rng = np.random.default_rng(5)
    oysters = tuple(
        Oyster(x=float(x), y=float(y), z=0.03, radii=(0.1, 0.07, 0.05), rpy=(0.0, 0.0, float(yaw)))
        for (x, y), yaw in zip(rng.normal((5.0, 4.0), (0.5, 0.35), (60, 2)), rng.uniform(-3, 3, 60), strict=True)
    )
    return ReefWorld(
        name="patch",
        size_m=(9.0, 8.0),
        start=Start(x=2.0, y=2.0, theta=0.5),
        clusters=(Cluster(name="a", oysters=oysters),),
        obstacles=(Obstacle(shape="cylinder", x=7.5, y=6.5, z=0.5, size=(0.2, 0.2, 0.5)),),
    )


def poses() -> list[Pose]:
    """A ring about the patch, looking inwards."""
    start = [Pose(2.0, 2.0, 0.5)]
    angles = np.linspace(0.0, 2 * math.pi, 40, endpoint=False)
    return start + [
        Pose(5.0 - 2.2 * math.cos(a), 4.0 - 2.0 * math.sin(a), math.remainder(a, 2 * math.pi)) for a in angles.tolist()
    ]


def write_run(folder, *, colour=False, drift=0.0, doubtful=False):
    """Write a run folder and return the map of its pictures, exact or with doubt at random as of a network."""
    world = patch()
    camera = Camera(Scene.from_world(world), CAMERA)
    writer = RunWriter(folder, COLUMNS)
    cells = OccupancyMap(world.size_m, CAMERA, MapCfg())
    recorder = FrameRecorder(writer, RecordCfg(frame_period_s=5.0))
    for k, pose in enumerate(poses()):
        frame = camera.render(pose)
        if colour:
            rgb = np.full((60, 80, 3), 120, np.uint8)
            rgb[frame.labels == 1] = (200, 40, 40)
            frame = type(frame)(frame.depth, frame.labels, frame.instances, rgb)
        if doubtful:
            doubt = np.random.default_rng(k).random(frame.depth.shape).astype(np.float32)
            frame = replace(frame, doubt=doubt)
        cells.integrate(frame, pose)
        odometry = Pose(pose.x + drift * k, pose.y, pose.theta)
        at = PicturePose(pose=pose, odometry=odometry, height_m=CAMERA.altitude_m)
        recorder.offer(5 * k, 0.5 * k, cells.cells, frame, at)
    recorder.close()
    writer.close()
    save_world(world, folder / "world.yaml")
    mission = {"simulator": {"camera": to_mapping(CAMERA)}, "map": to_mapping(MapCfg())}
    (folder / "config.yaml").write_text(yaml.safe_dump({"system": "reef", "world": "patch", "mission": mission}))
    return cells

"""A bag with a camera and a sonar."""

from dataclasses import replace

import numpy as np
import pytest
from survey_runs import CAMERA, patch, poses, write_run

from coral.errors import InputError
from coral.reef.map.mapping import OBSTACLE, MapCfg
from coral.reef.map.obstacle_layer import SonarLayerCfg
from coral.reef.map.sonar_3d15 import Sonar3d15, SonarCfg, sonar_attitude
from coral.reef.recordings.bag_export import write_bag
from coral.reef.recordings.bag_recording import BagTopics, read_bag
from coral.reef.recordings.recording import map_of
from coral.reef.recordings.run_recording import read_run
from coral.reef.recordings.transforms import quaternion_of
from coral.reef.world.scene import Scene

pytest.importorskip("rosbags")
SONAR = SonarCfg(enabled=True, width=64, height=24, pitch_down_deg=10.0)


def add_sonar(source, path, mount=True):
    """Copy a bag and add what a sonar hears at each picture's time."""
    from rosbags.highlevel import AnyReader
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    new = store.types
    sonar = Sonar3d15(Scene.from_world(patch()), SONAR, np.random.default_rng(0))

    def header(t, frame):
        stamp = new["builtin_interfaces/msg/Time"](sec=int(t), nanosec=round(t % 1 * 1e9))
        return new["std_msgs/msg/Header"](stamp=stamp, frame_id=frame)

    with (
        AnyReader([source], default_typestore=store) as reader,
        Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer,
    ):
        added = {
            one.topic: writer.add_connection(one.topic, one.msgtype, typestore=store) for one in reader.connections
        }
        clouds = writer.add_connection("/sonar/points", "sensor_msgs/msg/PointCloud2", typestore=store)
        if mount:
            x, y, z, w = quaternion_of(sonar_attitude(0.0, 0.0, 0.0, SONAR.pitch_down_deg))
            turned = new["geometry_msgs/msg/Transform"](
                translation=new["geometry_msgs/msg/Vector3"](x=0.0, y=0.0, z=0.0),
                rotation=new["geometry_msgs/msg/Quaternion"](x=x, y=y, z=z, w=w),
            )
            stamped = new["geometry_msgs/msg/TransformStamped"](
                header=header(0.0, "base_link"), child_frame_id="sonar", transform=turned
            )
            message = new["tf2_msgs/msg/TFMessage"](transforms=[stamped])
            writer.write(added["/tf_static"], 0, store.serialize_cdr(message, "tf2_msgs/msg/TFMessage"))
        for k, pose in enumerate(poses()):
            image = sonar.image(pose, CAMERA.altitude_m)
            heard = np.isfinite(image.ranges)
            points = (image.directions()[heard] * image.ranges[heard][:, None]).astype("<f4")
            fields = [
                new["sensor_msgs/msg/PointField"](name=n, offset=4 * i, datatype=7, count=1)
                for i, n in enumerate("xyz")
            ]
            message = new["sensor_msgs/msg/PointCloud2"](
                header=header(0.5 * k, "sonar"), height=1, width=len(points), fields=fields, is_bigendian=False,
                point_step=12, row_step=12 * len(points), data=points.view(np.uint8).ravel(), is_dense=True,
            )  # fmt: skip
            raw = store.serialize_cdr(message, "sensor_msgs/msg/PointCloud2")
            writer.write(clouds, round(0.5 * k * 1e9), raw)
        for connection, t, raw in reader.messages():
            writer.write(added[connection.topic], t, raw)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sonar")
    write_run(folder / "run")
    write_bag(read_run(folder / "run").located(), folder / "plain", single_file=False)
    add_sonar(folder / "plain", folder / "heard")
    return folder


def test_the_sonars_obstacles_reach_the_map_and_the_cameras_oysters_stay(recorded):
    beams, farther = SonarCfg(width=64, height=24), MapCfg(sonar=SonarLayerCfg(range_m=8.0))  # the ring is 6 m away
    heard = replace(read_bag(recorded / "heard", BagTopics(), sonar=beams), map=farther).located()
    assert heard.sonar.pitch_down_deg == pytest.approx(SONAR.pitch_down_deg)
    assert len(next(iter(heard.keyframes())).pings) == 1
    cells = map_of(heard)
    assert cells.layer is not None
    iy, ix = np.nonzero(cells.layer.obstacle)
    # The post at (7.5, 6.5), 0.2 m thick.
    assert len(iy) > 3
    assert np.hypot((ix + 0.5) * 0.05 - 7.5, (iy + 0.5) * 0.05 - 6.5).max() < 0.45
    assert (cells.cells()[cells.layer.obstacle] == OBSTACLE).all()
    plain = map_of(read_bag(recorded / "plain", BagTopics()).located())
    assert (cells.target == plain.target).mean() > 0.999


def test_eyes_are_given_the_echoes_in_their_picture(recorded):
    from given_eyes import FlatEyes

    from coral.reef.recordings.perception import PicturePerception

    write_run(recorded / "colour", colour=True)
    write_bag(read_run(recorded / "colour").located(), recorded / "shown", single_file=False)
    add_sonar(recorded / "shown", recorded / "both")
    eyes = FlatEyes()
    bag = read_bag(recorded / "both", BagTopics(), perception=PicturePerception(eyes, "flat"), sonar=SONAR)
    exact = read_bag(recorded / "plain", BagTopics())
    next(iter(bag.keyframes()))
    depth = next(iter(exact.keyframes())).frame.depth
    at = np.round(eyes.attitude.echoes[:, :2]).astype(int)
    there = depth[at[:, 1], at[:, 0]]
    near = np.isfinite(there) & (eyes.attitude.echoes[:, 2] < 3.0)
    assert near.sum() > 100
    assert np.median(np.abs(there[near] / eyes.attitude.echoes[near, 2] - 1.0)) < 0.03


def test_a_sonar_whose_place_nobody_knows_is_refused(recorded):
    add_sonar(recorded / "plain", recorded / "lost", mount=False)
    with pytest.raises(InputError, match="/tf_static: found no chain from base_link to sonar"):
        read_bag(recorded / "lost", BagTopics())

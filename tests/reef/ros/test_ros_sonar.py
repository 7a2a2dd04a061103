import math

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.ros import heard_tree, ros_sonar
from reef.ros.fake_ros import FakeNode, fake_type, message, mounted

LEVEL = SonarCfg(pitch_down_deg=0.0)
AHEAD = (LEVEL.height // 2, LEVEL.width // 2)


@pytest.fixture(autouse=True)
def types(monkeypatch):
    for module in (ros_sonar, heard_tree):
        monkeypatch.setattr(module, "ros_type", fake_type)
    monkeypatch.setattr(ros_sonar, "FIRST_S", 0.0)
    monkeypatch.setattr(ros_sonar, "NEXT_S", 0.01)
    monkeypatch.setattr(ros_sonar, "SEEN", 0.0)


class Publishing(FakeNode):
    def __init__(self, kind):
        super().__init__()
        self.kinds = [kind]

    def get_topic_names_and_types(self):
        return [("/ranges", self.kinds)]


def cloud(*points, frame="base_link"):
    fields = [message(name=name, offset=4 * k, datatype=7) for k, name in enumerate("xyz")]
    data = np.array(points, "<f4").view(np.uint8).ravel()
    return message(
        header={"stamp": 5.0, "frame_id": frame},
        fields=fields,
        width=len(points),
        height=1,
        point_step=12,
        is_bigendian=False,
        data=data,
    )


def sonar(kind="sensor_msgs/msg/PointCloud2", cfg=LEVEL):
    node = Publishing(kind)
    return ros_sonar.RosSonar("/ranges", cfg, node=node), node


def test_a_point_ahead_is_heard_ahead():
    heard, node = sonar()
    node.heard["/ranges"](cloud((3.0, 0.01, 0.01)))
    found = heard.read()
    assert found.t == 5.0
    assert np.nanmin(found.value.ranges) == pytest.approx(3.0, abs=1e-3)
    assert np.abs(np.argwhere(np.isfinite(found.value.ranges))[0] - AHEAD).max() <= 1
    assert heard.read() is None


def test_ranges_are_told_from_the_vehicle_and_the_tilt_that_the_map_reckons_with():
    heard, node = sonar(cfg=SonarCfg(pitch_down_deg=20.0))
    node.heard["/tf_static"](mounted("base_link", "head", at=(0.5, 0.0, 0.0)))
    down = math.radians(20.0)
    node.heard["/ranges"](cloud((2.5 * math.cos(down) - 0.5, 0.0, -2.5 * math.sin(down)), frame="head"))
    ranges = heard.read().value.ranges
    row, column = np.argwhere(np.isfinite(ranges))[0]
    assert ranges[row, column] == pytest.approx(2.5, abs=1e-3)
    assert abs(row - AHEAD[0]) <= 1
    assert abs(column - AHEAD[1]) <= 1


def test_a_sensor_in_an_unknown_place_is_told():
    heard, node = sonar()
    node.heard["/ranges"](cloud((3.0, 0.0, 0.0), frame="head"))
    with pytest.raises(UnfitMeasurement, match="no transform") as raised:
        heard.read()
    assert "base_link to 'head'" in raised.value.detail


def test_a_narrower_sensor_than_the_map_reckons_with_is_refused(monkeypatch):
    monkeypatch.setattr(ros_sonar, "SEEN", 0.8)
    heard, node = sonar()
    node.heard["/ranges"](cloud((3.0, 1.0, 1.0), (3.0, -1.0, -1.0)))
    with pytest.raises(UnfitMeasurement, match="narrow") as raised:
        heard.read()
    assert "37 by 35 degrees, the configured sonar has 90 by 40" in raised.value.detail
    node.heard["/ranges"](cloud((3.0, 3.0, 1.0)))
    assert heard.read() is not None


def test_a_transform_without_a_rotation_changes_nothing():
    heard, node = sonar()
    node.heard["/tf_static"](mounted("base_link", "head", at=(1.0, 0.0, 0.0)))
    node.heard["/tf"](mounted("base_link", "head", turn=(0.0, 0.0, 0.0, 0.0)))
    node.heard["/ranges"](cloud((3.0, 0.0, 0.0), frame="head"))
    assert heard.read().value.ranges.min() == pytest.approx(4.0, abs=1e-3)


@pytest.mark.parametrize(
    ("kinds", "told"),
    [([], "nobody publishes /ranges"), (["std_msgs/msg/String"], "std_msgs/msg/String on /ranges")],
)
def test_a_topic_without_ranges_is_one_line(kinds, told):
    node = Publishing("")
    node.kinds = kinds
    with pytest.raises(InputError, match=told):
        ros_sonar.RosSonar("/ranges", LEVEL, node=node)
    assert node.closed

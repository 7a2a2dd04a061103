import pytest

from coral.errors import InputError
from coral.ros_node import beside, ros_type


def test_without_ros_the_flag_and_the_way_out_are_named():
    with pytest.raises(InputError, match=r"--camera: found no nowhere_msgs .* source its setup.bash"):
        ros_type("nowhere_msgs.msg.Image", "--camera")


@pytest.mark.parametrize(("topic", "found"), [("/front/image", "/front/info"), ("image", "info"), ("/image", "/info")])
def test_a_topic_beside_another_one(topic, found):
    assert beside(topic, "info") == found

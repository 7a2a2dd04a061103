"""What is a bag, and what is none."""

import struct

import pytest

from coral.bag_reader import count_messages, is_bag, read_messages
from coral.errors import InputError
from test_foreign_file import within_limits

pytest.importorskip("rosbags")


def test_a_suffix_or_a_table_of_contents_makes_a_bag(tmp_path):
    assert is_bag(tmp_path / "x.mcap")
    assert is_bag(tmp_path / "x.bag")
    assert not is_bag(tmp_path)
    (tmp_path / "x_0.db3").write_text("")
    assert is_bag(tmp_path)
    (tmp_path / "metadata.yaml").write_text("")
    assert is_bag(tmp_path)


@pytest.mark.parametrize("content", [b"", b"no recording", b"\x89MCAP0\r\n", b"\x89MCAP0\r\n" + b"\0" * 100])
def test_a_file_that_is_none_is_one_line(tmp_path, content):
    path = tmp_path / "x.mcap"
    path.write_bytes(content)
    for read in (lambda: count_messages(path), lambda: list(read_messages(path, {"/odometry"}))):
        with pytest.raises(InputError, match=r"x\.mcap: found .*, expected") as told:
            read()
        assert "\n" not in str(told.value)


def test_a_file_of_eight_bytes_is_damaged(tmp_path):
    (tmp_path / "x.mcap").write_bytes(b"\x89MCAP0\r\n")
    with pytest.raises(InputError, match=r"x\.mcap: found damaged bytes, expected a ROS bag or an MCAP file"):
        count_messages(tmp_path / "x.mcap")


def test_a_chunk_is_unpacked_no_further_than_any_chunk_holds(tmp_path):
    """A chunk of zeros: 60 kB in the file, 2 GB when unpacked. It says so, or says that it is small."""
    zstd = pytest.importorskip("rosbags.rosbag2.storage_mcap").zstd
    data = zstd.compress(bytes(50_000_000)) * 40
    for size in (2_000_000_000, 1000):
        chunk = struct.pack("<QQQII4sQ", 0, 0, size, 0, 4, b"zstd", len(data)) + data
        header = struct.pack("<BQI4sI", 1, 12, 4, b"ros2", 0)
        end = struct.pack("<BQI", 0x0F, 4, 0) + struct.pack("<BQQQI", 2, 20, 0, 0, 0)
        path = tmp_path / "x.mcap"
        path.write_bytes(b"\x89MCAP0\r\n" + header + struct.pack("<BQ", 6, len(chunk)) + chunk + end + b"\x89MCAP0\r\n")
        told = within_limits(path, "from coral.bag_reader import count_messages", "count_messages(path)")
        assert "x.mcap: found" in told
        assert told.endswith("expected a ROS bag or an MCAP file\n")


@pytest.mark.parametrize("packing", ["BZ2", "LZ4"])
def test_a_chunk_of_a_ros_1_bag_is_bounded_too(tmp_path, packing, monkeypatch):
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    bag = Writer(tmp_path / "x.bag")
    bag.set_compression(Writer.CompressionFormat[packing])
    with bag as writer:
        topic = writer.add_connection("/odometry", "std_msgs/msg/String", typestore=store)
        word = store.types["std_msgs/msg/String"](data="a" * 500_000)
        writer.write(topic, 1, store.serialize_ros1(word, "std_msgs/msg/String"))
    assert len(list(read_messages(tmp_path / "x.bag", {"/odometry"}))) == 1
    monkeypatch.setattr("coral.bag_reader.CHUNK_BYTES", 400_000)
    with pytest.raises(InputError, match=r"x\.bag: found a chunk of more than 0 MB"):
        list(read_messages(tmp_path / "x.bag", {"/odometry"}))


def test_a_table_of_contents_is_read_with_limits(tmp_path):
    (tmp_path / "metadata.yaml").write_text("[" * 30_000)
    with pytest.raises(InputError, match=r"metadata\.yaml: line 1: found values nested more than 50 deep"):
        count_messages(tmp_path)

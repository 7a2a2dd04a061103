"""What is a bag, and what is none."""

import sqlite3
import struct

import pytest

from coral.errors import InputError
from coral.ros.bag_reader import Bag, is_bag
from test_foreign_file import within_limits

pytest.importorskip("rosbags")

from rosbags.typesys import Stores, get_typestore


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
    for read in (lambda: Bag(path).count_messages(), lambda: list(Bag(path).read_messages({"/odometry"}))):
        with pytest.raises(InputError, match=r"x\.mcap: found .*, expected") as told:
            read()
        assert "\n" not in str(told.value)


def test_a_file_of_eight_bytes_is_damaged(tmp_path):
    (tmp_path / "x.mcap").write_bytes(b"\x89MCAP0\r\n")
    with pytest.raises(InputError, match=r"x\.mcap: found damaged bytes, expected a ROS bag or an MCAP file"):
        Bag(tmp_path / "x.mcap").count_messages()


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
        told = within_limits(path, "from coral.ros.bag_reader import Bag", "Bag(path).count_messages()")
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
    assert len(list(Bag(tmp_path / "x.bag").read_messages({"/odometry"}))) == 1
    monkeypatch.setattr("coral.ros.bag_reader.CHUNK_BYTES", 400_000)
    with pytest.raises(InputError, match=r"x\.bag: found a chunk of more than 0 MB"):
        list(Bag(tmp_path / "x.bag").read_messages({"/odometry"}))


def test_a_table_of_contents_is_read_with_limits(tmp_path):
    (tmp_path / "metadata.yaml").write_text("[" * 30_000)
    with pytest.raises(InputError, match=r"metadata\.yaml: line 1: found values nested more than 50 deep"):
        Bag(tmp_path).count_messages()


def poses(count, store, **other):
    """Return points, one a tenth of a second."""
    types = store.types
    for k in range(count):
        stamp = types["builtin_interfaces/msg/Time"](sec=k // 10, nanosec=k % 10 * 100_000_000)
        header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="odom", **other)
        yield (
            k * 100_000_000,
            types["geometry_msgs/msg/PointStamped"](
                header=header, point=types["geometry_msgs/msg/Point"](x=float(k), y=0.0, z=0.0)
            ),
        )


def write_ros2(path, storage="SQLITE3"):
    from rosbags.rosbag2 import StoragePlugin, Writer

    store = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(path, version=9, storage_plugin=StoragePlugin[storage]) as writer:
        topic = writer.add_connection("/at", "geometry_msgs/msg/PointStamped", typestore=store)
        for t, message in poses(2000, store):
            writer.write(topic, t, store.serialize_cdr(message, "geometry_msgs/msg/PointStamped"))
    return next(path.glob(f"*.{'db3' if storage == 'SQLITE3' else 'mcap'}"))


def write_ros1(path):
    from rosbags.rosbag1 import Writer

    store = get_typestore(Stores.ROS1_NOETIC)
    writer = Writer(path)
    writer.chunk_threshold = 2000
    with writer:
        topic = writer.add_connection("/at", "geometry_msgs/msg/PointStamped", typestore=store)
        for t, message in poses(400, store, seq=0):
            writer.write(topic, t, store.serialize_ros1(message, "geometry_msgs/msg/PointStamped"))
    return path


@pytest.mark.parametrize("part", [0.05, 0.4, 0.97])
def test_a_cut_file_is_one_line_that_names_the_next_step(tmp_path, part):
    for whole, suffix, said in (
        (write_ros2(tmp_path / "mcap", "MCAP"), "mcap", r"mcap recover FILE -o OUT.*ros2 bag reindex FOLDER"),
        (write_ros2(tmp_path / "db3"), "db3", r"\.recover.*ros2 bag reindex FOLDER"),
        (write_ros1(tmp_path / "whole.bag"), "bag", "rosbag reindex FILE"),
    ):
        cut = tmp_path / f"cut.{suffix}"
        cut.write_bytes(whole.read_bytes()[: int(part * whole.stat().st_size)])
        with pytest.raises(InputError, match=said) as told:
            Bag(cut).count_messages()
        assert "\n" not in str(told.value)


def test_a_sqlite_bag_whose_tables_compute_is_refused(tmp_path):
    path = write_ros2(tmp_path / "bag")
    with sqlite3.connect(path) as base:
        base.execute("ALTER TABLE topics RENAME TO kept")
        base.execute("CREATE VIEW topics AS SELECT * FROM kept")
    with pytest.raises(InputError, match="topics: found a view, expected a table"):
        Bag(path).count_messages()

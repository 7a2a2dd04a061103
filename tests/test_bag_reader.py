"""What is a bag, and what is none."""

import pytest

from coral.bag_reader import count_messages, is_bag, read_messages
from coral.errors import InputError

pytest.importorskip("rosbags")


def test_a_suffix_or_a_table_of_contents_makes_a_bag(tmp_path):
    assert is_bag(tmp_path / "x.mcap")
    assert is_bag(tmp_path / "x.bag")
    assert not is_bag(tmp_path)
    (tmp_path / "x_0.db3").write_text("")
    assert is_bag(tmp_path)
    (tmp_path / "metadata.yaml").write_text("")
    assert is_bag(tmp_path)


@pytest.mark.parametrize("content", [b"", b"no recording", b"\x89MCAP0\r\n" + b"\0" * 100])
def test_a_file_that_is_none_is_one_line(tmp_path, content):
    path = tmp_path / "x.mcap"
    path.write_bytes(content)
    for read in (lambda: count_messages(path), lambda: list(read_messages(path, {"/odometry"}))):
        with pytest.raises(InputError, match=r"x\.mcap: found .*, expected") as told:
            read()
        assert "\n" not in str(told.value)

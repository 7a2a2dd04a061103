"""Files of bags without their end."""

import io
import struct

import pytest

from coral.ros.unfinished_bag import MAGIC, PathWithEnd, mend, whole_bytes

HEADER = struct.pack("<BQ", 0x01, 12) + bytes(12)
RECORDS = b"".join(struct.pack("<BQ", 0x05, size) + bytes([size]) * size for size in (30, 50))
DATA_END = struct.pack("<BQI", 0x0F, 4, 0)
WHOLE = MAGIC + HEADER + RECORDS


@pytest.mark.parametrize("content", [b"", b"\x89MC", b"no recording at all", WHOLE + DATA_END + MAGIC])
def test_a_file_with_its_end_and_a_file_of_another_kind_are_left_alone(content):
    assert whole_bytes(io.BytesIO(content)) is None


@pytest.mark.parametrize(
    ("content", "whole"),
    [
        (WHOLE, len(WHOLE)),
        (WHOLE[:-1], len(WHOLE) - 59),
        (WHOLE[:-55], len(WHOLE) - 59),
        (WHOLE + DATA_END + HEADER, len(WHOLE)),
        (WHOLE + bytes(100), len(WHOLE)),
        (WHOLE + struct.pack("<BQ", 0x05, 2**63), len(WHOLE)),
    ],
)
def test_whole_records_end_where_one_is_cut_or_none_any_more(content, whole):
    assert whole_bytes(io.BytesIO(content)) == whole


@pytest.mark.parametrize("cut", [0, 1, 40])
def test_the_file_gets_its_end_when_it_is_opened(tmp_path, cut):
    path = tmp_path / "x.mcap"
    path.write_bytes(WHOLE[: len(WHOLE) - cut])
    with mend(path, tmp_path).path.open("rb") as file:
        content = file.read()
        assert file.seek(-37, 2) == len(content) - 37
        assert file.read() == content[-37:]
        file.seek(3)
        assert file.read(20) == content[3:23]
    assert content == WHOLE[: len(WHOLE) - (59 if cut else 0)] + content[-50:]
    assert content[-50:-37] == DATA_END
    assert content.endswith(MAGIC)
    assert path.read_bytes() == WHOLE[: len(WHOLE) - cut]


def test_all_else_of_the_path_is_its_own(tmp_path):
    path = PathWithEnd(tmp_path / "x.mcap", 0, b"")
    assert (path.name, path.exists(), str(path)) == ("x.mcap", False, str(tmp_path / "x.mcap"))

"""A block is read whole or not at all."""

import pytest

from coral.contact.franka.shared_block import SharedBlock


def test_what_was_written_last_is_read():
    block = SharedBlock("nothing")
    assert block.read() == "nothing"
    block.write([1.0])
    block.write({"poses": [4.0, 5.0]})
    assert block.read() == {"poses": [4.0, 5.0]}


def test_while_a_writer_is_at_work_the_value_before_holds():
    block = SharedBlock(0)
    block.write(1)
    block.read()
    block._head[0] += 1
    block._body[0] = 255
    assert block.read() == 1


def test_what_is_too_large_is_no_half_value():
    block = SharedBlock(b"")
    with pytest.raises(ValueError, match="for a block of"):
        block.write(bytes(100_000))
    assert block.read() == b""

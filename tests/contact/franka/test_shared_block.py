"""A block is read whole or not at all."""

import numpy as np
import pytest

from coral.contact.franka.shared_block import SharedBlock


def test_what_was_written_last_is_read():
    block = SharedBlock(3)
    assert block.read() == pytest.approx(np.zeros(3))
    block.write(np.array([1.0, 2.0, 3.0]))
    block.write(np.array([4.0, 5.0, 6.0]))
    assert block.read() == pytest.approx([4.0, 5.0, 6.0])


def test_while_a_writer_is_at_work_the_numbers_before_hold():
    block = SharedBlock(1)
    block.write(np.array([1.0]))
    block.read()
    block._raw[0] += 1.0
    block._raw[1] = 2.0
    assert block.read() == pytest.approx([1.0])

import contextlib

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.contact.policy.wire import WireError, decode, encode


def raw(**fields):
    """An array as bytes that say what the test wants."""
    whole = {"dtype": "<f4", "shape": [2], "data": bytes(8), **fields}
    return msgspec.msgpack.encode({b"__ndarray__": True, **{name.encode(): value for name, value in whole.items()}})


@pytest.mark.parametrize(
    "array",
    [
        np.arange(6, dtype=np.uint8).reshape(1, 2, 3),
        np.array([[1.5, np.nan]], np.float32),
        np.zeros((0, 7)),
        np.array([True, False]),
        np.array(3, np.int64),
        np.arange(12.0).reshape(3, 4).T,
        np.arange(3, dtype=">i2"),
    ],
    ids=lambda array: f"{array.dtype.str}{array.shape}",
)
def test_an_array_comes_back_as_it_went(array):
    back = decode(encode({"a": array}))["a"]
    np.testing.assert_array_equal(back, array)
    assert (back.dtype, back.flags.writeable) == (array.dtype, True)


def test_the_bytes_are_those_of_openpi():
    # {b"__ndarray__": True, b"data": b"\x01", b"dtype": "|u1", b"shape": (1,)} by msgpack's own rules
    wanted = b"\x84\xc4\x0b__ndarray__\xc3\xc4\x04data\xc4\x01\x01\xc4\x05dtype\xa3|u1\xc4\x05shape\x91\x01"
    assert encode({"a": np.array([1], np.uint8)}) == b"\x81\xa1a" + wanted


def test_texts_numbers_and_scalars_are_read():
    scalar = {b"__npgeneric__": True, b"data": 2.5, b"dtype": "<f4"}
    assert decode(msgspec.msgpack.encode({"a": [1, None, "b", scalar]})) == {"a": [1, None, "b", 2.5]}


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"dtype": "|O"}, "dtype '|O'"),
        ({"dtype": "O"}, "dtype 'O'"),
        ({"dtype": "<V2"}, "dtype"),
        ({"dtype": "<c8"}, "dtype"),
        ({"dtype": "<U4"}, "dtype"),
        ({"dtype": "<M8"}, "dtype"),
        ({"dtype": [["a", "O"]]}, "dtype"),
        ({"dtype": b"<f4"}, "dtype"),
        ({"dtype": "f1"}, "dtype"),
        ({"dtype": None}, "dtype"),
        ({"shape": [3]}, "in 8 bytes"),
        ({"shape": [2**62, 2**62]}, "shape"),
        ({"shape": [0, 2**62], "data": b""}, "shape"),
        ({"shape": [-2]}, "shape"),
        ({"shape": [True, 2]}, "shape"),
        ({"shape": "2"}, "shape"),
        ({"shape": [1] * 60 + [2]}, "shape"),
        ({"data": "12345678"}, "in 0 bytes"),
        ({"data": [1.0, 2.0]}, "in 0 bytes"),
    ],
)
def test_an_array_that_is_not_plain_numbers_is_refused(fields, said):
    with pytest.raises(WireError) as refused:
        decode(raw(**fields))
    assert said in str(refused.value)


def test_objects_are_not_sent_either():
    with pytest.raises(WireError, match="dtype"):
        encode({"a": np.array([object()])})
    with pytest.raises(WireError, match="object cannot be sent"):
        encode({"a": object()})


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\xc1",
        b"\x01\x01",
        b"\xdd\xff\xff\xff\xff",
        b"\x91" * 100_000 + b"\x01",
        b"\x81" * 5000 + b"\x00" * 5001,
        b"\xc7\x03\x01abc",
        b"\x81\xc4\x0b__ndarray__\xc3",
        b"\x81\x81\x01\x02\x03",
        b"\x80\x04\x95pickle",
        b"\x82\xc4\x0f__npgeneric__\xc3\xc4\x04data\x90",
    ],
)
def test_what_is_no_message_is_refused(data):
    with pytest.raises(WireError):
        decode(data)


@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(data):
    with contextlib.suppress(WireError):
        decode(data)

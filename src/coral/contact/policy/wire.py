"""Messages of openpi's policy servers: MessagePack, arrays as maps of bytes, dtype and shape. Never pickle.

Source: openpi's client package (msgpack_numpy): an array is `{b"__ndarray__": True, b"data", b"dtype", b"shape"}`, a
NumPy scalar `{b"__npgeneric__": True, b"data", b"dtype"}`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

PLAIN = re.compile(r"[<>|=]?[biuf][1248]")
"""Supported dtypes: booleans, integers and floats. Others, such as objects, could contain code or be ambiguous."""
LONGEST_AXIS = 2**31
MOST_AXES = 8


class WireError(ValueError):
    """A message that cannot be read, or not safely."""


def encode(message: Mapping[str, Any]) -> bytes:
    """Encode a message as bytes.

    Raises:
        WireError: It contains an array of objects, or another value that cannot be sent.
    """
    try:
        return msgspec.msgpack.encode(dict(message), enc_hook=_pack)
    except (TypeError, OverflowError, RecursionError) as error:
        raise WireError(str(error)) from None


def decode(data: bytes) -> Any:
    """Decode a message; its arrays are writable copies.

    Raises:
        WireError: It is not MessagePack, or contains an array that is not plain numbers of the stated size.
    """
    try:
        return _unpack(msgspec.msgpack.decode(data))
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise WireError(f"no MessagePack: {error}") from None
    except RecursionError:
        raise WireError("nested without end") from None
    except TypeError as error:  # a map as the key of a map
        raise WireError(str(error)) from None


def _pack(value: Any) -> Any:
    if not isinstance(value, np.ndarray):
        raise TypeError(f"a {type(value).__name__} cannot be sent")
    dtype = _plain(value.dtype.str).str
    return {b"__ndarray__": True, b"data": value.tobytes(), b"dtype": dtype, b"shape": value.shape}


def _unpack(value: Any) -> Any:
    if isinstance(value, dict):
        if marked(value, "__ndarray__"):
            return _array(value)
        if marked(value, "__npgeneric__"):
            held = field(value, "data")
            if not isinstance(held, bool | int | float):
                raise WireError(f"a scalar that is a {type(held).__name__}")
            _plain(field(value, "dtype"))
            return held
        return {key: _unpack(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_unpack(item) for item in value]
    if isinstance(value, msgspec.msgpack.Ext):
        raise WireError(f"an extension of type {value.code}")
    return value


def marked(value: Mapping[Any, Any], mark: str) -> bool:
    """Check whether a map encodes an array or scalar; servers in other languages may send the mark as text."""
    return mark.encode() in value or mark in value


def field(value: Mapping[Any, Any], name: str) -> Any:
    """Read a field of such a map.

    Raises:
        WireError: The field is missing.
    """
    if not marked(value, name):
        raise WireError(f"an array without {name}")
    return value[name.encode()] if name.encode() in value else value[name]


def _array(value: Mapping[Any, Any]) -> NDArray[Any]:
    dtype, shape, data = _plain(field(value, "dtype")), field(value, "shape"), field(value, "data")
    whole = isinstance(shape, list) and all(type(n) is int and n >= 0 for n in shape)
    if not whole or len(shape) > MOST_AXES or max(shape, default=0) > LONGEST_AXIS:
        raise WireError(f"an array of shape {str(shape)[:60]}")
    if not isinstance(data, bytes) or math.prod(shape) * dtype.itemsize != len(data):
        size = len(data) if isinstance(data, bytes) else 0
        raise WireError(f"an array of shape {tuple(shape)} and dtype {dtype.str} in {size} bytes")
    return np.frombuffer(data, dtype).reshape(shape).copy()


def _plain(name: Any) -> np.dtype[Any]:
    if not isinstance(name, str) or PLAIN.fullmatch(name) is None:
        raise WireError(f"an array of dtype {str(name)[:60]!r}: only truth values, whole numbers and floats are taken")
    try:
        return np.dtype(name)
    except TypeError:  # as f1
        raise WireError(f"an array of dtype {name!r}, which NumPy does not have") from None

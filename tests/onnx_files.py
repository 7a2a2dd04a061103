"""Small ONNX files, written byte by byte: the package onnx is not needed for a handful of nodes (onnx.proto, IR 8)."""

import struct

import numpy as np

FLOAT, INT64 = 1, 7


def _varint(value):
    value &= (1 << 64) - 1
    out = b""
    while value > 0x7F:
        out, value = out + bytes([value & 0x7F | 0x80]), value >> 7
    return out + bytes([value])


def _int(field, value):
    return _varint(field << 3) + _varint(value)


def _bytes(field, content):
    content = content.encode() if isinstance(content, str) else content
    return _varint(field << 3 | 2) + _varint(len(content)) + content


def tensor(name, values):
    """A constant."""
    values = np.asarray(values)
    kind, dtype = (INT64, "<i8") if values.dtype.kind == "i" else (FLOAT, "<f4")
    dims = b"".join(_int(1, size) for size in values.shape)
    return dims + _int(2, kind) + _bytes(8, name) + _bytes(9, values.astype(dtype).tobytes())


def node(kind, inputs, outputs, **attributes):
    """An operation; attributes are whole numbers, lists of them, or floats."""
    out = b"".join(_bytes(1, name) for name in inputs) + b"".join(_bytes(2, name) for name in outputs)
    out += _bytes(4, kind)
    for name, value in attributes.items():
        if isinstance(value, list):
            content = b"".join(_int(8, one) for one in value) + _int(20, 7)
        elif isinstance(value, float):
            content = _varint(2 << 3 | 5) + struct.pack("<f", value) + _int(20, 1)
        else:
            content = _int(3, value) + _int(20, 2)
        out += _bytes(5, _bytes(1, name) + content)
    return out


def _value(name, shape):
    dims = b"".join(_bytes(1, _int(1, size)) for size in shape)
    return _bytes(1, name) + _bytes(2, _bytes(1, _int(1, FLOAT) + _bytes(2, dims)))


def model(nodes, constants, inputs, outputs, metadata=None):
    """The bytes of a file; inputs and outputs are shapes by name."""
    graph = b"".join(_bytes(1, one) for one in nodes) + _bytes(2, "g")
    graph += b"".join(_bytes(5, tensor(name, values)) for name, values in constants.items())
    graph += b"".join(_bytes(11, _value(*one)) for one in inputs.items())
    graph += b"".join(_bytes(12, _value(*one)) for one in outputs.items())
    notes = b"".join(_bytes(14, _bytes(1, key) + _bytes(2, value)) for key, value in (metadata or {}).items())
    return _int(1, 8) + _bytes(7, graph) + _bytes(8, _bytes(1, "") + _int(2, 13)) + notes


def red_is_oyster(width, height):
    """A semantic network: what is redder than green is an oyster, all else sea floor."""
    weights, bias = np.zeros((4, 3, 1, 1), np.float32), np.array([-9.0, -2.0, -9.0, 2.0], np.float32)
    weights[1, :2, 0, 0] = 14.0, -14.0
    shape = (1, 3, height, width)
    return model(
        [node("Conv", ["picture", "w", "b"], ["logits"], kernel_shape=[1, 1])],
        {"w": weights, "b": bias}, {"picture": shape}, {"logits": (1, 4, height, width)},
    )  # fmt: skip


def red_is_oyster_yolo(size):
    """A YOLO segmentation network: one oyster whose mask is what is redder than green, and a rock that never is."""
    prototypes, bias = np.zeros((32, 3, 1, 1), np.float32), np.full(32, -1.0, np.float32)
    prototypes[0, :2, 0, 0], bias[0] = (60.0, -60.0), -5.0
    raw = np.zeros((1, 4 + 2 + 32, 2), np.float32)
    raw[0, :4] = np.array([[size / 2], [size / 2], [size], [size]])
    raw[0, 4, 0], raw[0, 6, 0] = 0.9, 1.0
    raw[0, 5, 1], raw[0, 7, 1] = 0.4, 1.0
    return model(
        [
            node("Conv", ["images", "w", "b"], ["output1"], kernel_shape=[1, 1]),
            node("ReduceMean", ["images"], ["mean"], keepdims=0),
            node("Mul", ["mean", "zero"], ["nothing"]),
            node("Add", ["raw", "nothing"], ["output0"]),
        ],
        {"w": prototypes, "b": bias, "raw": raw, "zero": np.float32(0.0)},
        {"images": (1, 3, size, size)},
        {"output0": raw.shape, "output1": (1, 32, size, size)},
        {"names": "{0: 'oyster', 1: 'rock'}"},
    )  # fmt: skip


def relative_depth(relative):
    """A network of Depth Anything's layout that sees the same relative inverse depth in all pictures. Shape=(h, w)."""
    height, width = relative.shape
    return model(
        [
            node("ReduceMean", ["pixel_values"], ["mean"], axes=[1], keepdims=0),
            node("Mul", ["mean", "zero"], ["nothing"]),
            node("Add", ["known", "nothing"], ["predicted_depth"]),
        ],
        {"known": np.asarray(relative, np.float32)[None], "zero": np.float32(0.0)},
        {"pixel_values": (1, 3, height, width)},
        {"predicted_depth": (1, height, width)},
    )  # fmt: skip


def prompted_pair(size):
    """An encoder that passes the picture on, and a decoder whose mask is what is redder than green, at a quarter."""
    weights, bias = np.zeros((1, 3, 1, 1), np.float32), np.array([-0.5], np.float32)
    weights[0, :2, 0, 0] = 1.0, -1.0
    picture, small = (1, 3, size, size), size // 4
    encoder = model([node("Identity", ["images"], ["features"])], {}, {"images": picture}, {"features": picture})
    decoder = model(
        [
            node("AveragePool", ["features"], ["quarter"], kernel_shape=[4, 4], strides=[4, 4]),
            node("Conv", ["quarter", "w", "b"], ["low_res_masks"], kernel_shape=[1, 1]),
            node("ReduceMax", ["point_labels"], ["most"], keepdims=1),
            node("Identity", ["most"], ["iou_predictions"]),
        ],
        {"w": weights, "b": bias},
        {"features": picture, "point_coords": (1, 2, 2), "point_labels": (1, 2)},
        {"low_res_masks": (1, 1, small, small), "iou_predictions": (1, 1)},
    )
    return encoder, decoder

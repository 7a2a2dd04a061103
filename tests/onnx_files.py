"""Small ONNX files, written byte by byte: the package onnx is not needed for a handful of nodes (onnx.proto, IR 8)."""

import struct

import numpy as np

FLOAT, INT64, HALF = 1, 7, 10


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
    if values.dtype == np.float16:
        kind, dtype = HALF, "<f2"
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


def _value(name, shape, kind):
    dims = b"".join(_bytes(1, _bytes(2, size) if isinstance(size, str) else _int(1, size)) for size in shape)
    return _bytes(1, name) + _bytes(2, _bytes(1, _int(1, kind) + _bytes(2, dims)))


def model(nodes, constants, inputs, outputs, metadata=None, half=False, whole=()):
    """The bytes of a file; inputs and outputs are shapes by name, in which a text is a free size.

    With `half` all floats are of half precision; outputs in `whole` are whole numbers.
    """
    real = HALF if half else FLOAT
    graph = b"".join(_bytes(1, one) for one in nodes) + _bytes(2, "g")
    for name, values in constants.items():
        number = np.asarray(values)
        number = number.astype(np.float16) if half and number.dtype.kind == "f" else number
        graph += _bytes(5, tensor(name, number))
    graph += b"".join(_bytes(11, _value(*one, real)) for one in inputs.items())
    graph += b"".join(_bytes(12, _value(*one, INT64 if one[0] in whole else real)) for one in outputs.items())
    notes = b"".join(_bytes(14, _bytes(1, key) + _bytes(2, value)) for key, value in (metadata or {}).items())
    return _int(1, 8) + _bytes(7, graph) + _bytes(8, _bytes(1, "") + _int(2, 13)) + notes


MEAN, SPREAD = np.array([0.485, 0.456, 0.406], np.float32), np.array([0.229, 0.224, 0.225], np.float32)


def red_is_oyster(
    width, height, *, order=(0, 1, 2, 3), end="logits", names=("picture", "logits"), quarter=False, imagenet=False,
    bgr=False, **how,
):  # fmt: skip
    """A semantic network: what is redder than green is an oyster, all else sea floor.

    Args:
        width: Of the picture; a text where it is free.
        height: Of the picture.
        order: `Label` of each channel.
        end: logits, shares, or classes as whole numbers with 3 or 4 axes: classes3, classes4.
        names: Of input and output.
        quarter: Whether the map has a quarter of the picture's size.
        imagenet: Whether the picture is normalised.
        bgr: Whether blue comes first.
        how: For `model`.
    """
    weights, bias = np.zeros((4, 3, 1, 1), np.float32), np.array([-9.0, -2.0, -9.0, 2.0], np.float32)
    weights[1, :2, 0, 0] = 14.0, -14.0
    if imagenet:
        bias = bias + weights[:, :, 0, 0] @ MEAN
        weights = weights * SPREAD[None, :, None, None]
    weights, bias = weights[list(order)], bias[list(order)]
    if bgr:
        weights = weights[:, ::-1]
    source, target = names
    nodes, last = [node("Conv", [source, "w", "b"], ["raw"], kernel_shape=[1, 1])], "raw"
    shape = (1, 4, height, width)
    if quarter:
        nodes.append(node("AveragePool", [last], ["small"], kernel_shape=[4, 4], strides=[4, 4]))
        last, shape = "small", (1, 4, height // 4, width // 4)
    if end == "shares":
        nodes.append(node("Softmax", [last], [target], axis=1))
    elif end == "logits":
        nodes.append(node("Identity", [last], [target]))
    else:
        nodes.append(node("ArgMax", [last], [target], axis=1, keepdims=int(end == "classes4")))
        shape = (1, 1, *shape[2:]) if end == "classes4" else (1, *shape[2:])
        how["whole"] = {target}
    return model(nodes, {"w": weights, "b": bias}, {source: (1, 3, height, width)}, {target: shape}, **how)


def red_is_oyster_yolo(size, *, layout="classes", names=None, free=False, reverse=False, metadata=None, half=False):
    """A YOLO segmentation network: one oyster whose mask is what is redder than green, and a rock that never is.

    Args:
        size: Width and height of its pictures (px).
        layout: Of the candidates: classes, objectness or chosen.
        names: Of the two classes, as the metadata have them.
        free: Whether batch, height and width are free.
        reverse: Whether the prototypes come first.
        metadata: More of it.
        half: Whether floats have half precision.
    """
    prototypes, bias = np.zeros((32, 3, 1, 1), np.float32), np.full(32, -1.0, np.float32)
    prototypes[0, :2, 0, 0], bias[0] = (60.0, -60.0), -5.0
    middle = [size / 2, size / 2, size, size]
    first, second = [0.9, 0.0], [0.0, 0.125]
    tail = [1.0] + [0.0] * 31
    if layout == "classes":
        raw = np.array([middle + first + tail, middle + second + tail], np.float32).T[None]
    elif layout == "objectness":
        raw = np.array([[*middle, 0.9, 1.0, 0.0, *tail], [*middle, 0.125, 0.0, 1.0, *tail]], np.float32)[None]
    else:
        raw = np.array([[0, 0, size, size, 0.9, 0, *tail], [0, 0, size, size, 0.125, 1, *tail]], np.float32)[None]
    picture = ("n", 3, "h", "w") if free else (1, 3, size, size)
    outputs = {"output0": ("n", "a", "b") if free else raw.shape, "output1": ("n", 32, *picture[2:])}
    outputs = {name: outputs[name] for name in sorted(outputs, reverse=reverse)}
    return model(
        [
            node("Conv", ["images", "w", "b"], ["output1"], kernel_shape=[1, 1]),
            node("ReduceMean", ["images"], ["mean"], keepdims=0),
            node("Mul", ["mean", "zero"], ["nothing"]),
            node("Add", ["raw", "nothing"], ["output0"]),
        ],
        {"w": prototypes, "b": bias, "raw": raw, "zero": np.float32(0.0)},
        {"images": picture},
        outputs,
        {"names": names or "{0: 'oyster', 1: 'rock'}", **(metadata or {})},
        half,
    )


def relative_depth(relative, names=("pixel_values", "predicted_depth"), channel=False, free=False, **how):
    """A network of Depth Anything's layout that sees the same map in all pictures. Shape=(h, w).

    Args:
        relative: The map.
        names: Of input and output.
        channel: Whether the map has an axis for its one channel.
        free: Whether batch, height and width are free.
        how: For `model`.
    """
    source, target = names
    height, width = relative.shape
    known = np.asarray(relative, np.float32)[None, None] if channel else np.asarray(relative, np.float32)[None]
    shape = ("n", *([1] if channel else []), "h", "w") if free else known.shape
    return model(
        [
            node("ReduceMean", [source], ["mean"], axes=[1], keepdims=int(channel)),
            node("Mul", ["mean", "zero"], ["nothing"]),
            node("Add", ["known", "nothing"], [target]),
        ],
        {"known": known, "zero": np.float32(0.0)},
        {source: ("n", 3, "h", "w") if free else (1, 3, height, width)},
        {target: shape},
        **how,
    )

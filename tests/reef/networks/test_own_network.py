"""Networks of one's own, by their files: `coral.reef.networks`."""

import json

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.eyes.backends import open_eyes
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.eyes.reef_net import SHIPPED
from coral.reef.networks.relative_depth import RelativeDepthEyes
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Label
from onnx_files import red_is_oyster, red_is_oyster_yolo, relative_depth


def test_a_depth_network_needs_classes_from_elsewhere(tmp_path):
    pytest.importorskip("onnxruntime")
    path = tmp_path / "d.onnx"
    path.write_bytes(relative_depth(np.ones((14, 28))))
    with pytest.raises(InputError, match=r"d\.onnx: outputs: found predicted_depth alone, expected classes.*--depth"):
        open_eyes(str(path))
    with pytest.raises(InputError, match=r"--depth: found .*d\.onnx beside exact, expected --perception painted"):
        open_eyes("exact", depth=str(path))
    with pytest.raises(
        InputError, match=r"inputs, outputs: found picture .*expected a picture \(1, 3, height, width\)"
    ):
        open_eyes("rgb", depth=str(SHIPPED))
    assert isinstance(open_eyes("rgb", depth=str(path)), RelativeDepthEyes)


NAMES = {"0": "background", "1": "oyster", "2": "rock", "3": "sand"}
OURS = "classes: {0: water, 1: oyster, 2: obstacle, 3: seabed}"


def config(**more):
    return {"config.json": json.dumps({"model_type": "segformer", "id2label": NAMES} | more)}


def yolo(size=64, **how):
    return red_is_oyster_yolo(size, **how)


def semantic(width=64, height=48, **how):
    return red_is_oyster(width, height, **how)


def picture():
    rgb = np.full((48, 64, 3), (90, 120, 130), np.uint8)
    rgb[28:44, 20:40] = 200, 60, 50
    return rgb


def seen(tmp_path, content, beside=None):
    path = tmp_path / "net.onnx"
    path.write_bytes(content)
    for name, text in (beside or {}).items():
        (tmp_path / name).write_text(text)
    eyes = open_eyes(str(path))
    return eyes, eyes.perceive(picture(), CameraCfg(width=64, height=48), CameraAttitude())


TRANSFORMERS = ("pixel_values", "logits")
LAYOUTS = {
    "YOLOv8, 11": (yolo(), {}),
    "YOLOv8, half precision": (yolo(half=True), {}),
    "YOLOv8, free axes": (yolo(free=True, metadata={"imgsz": "[64, 64]"}), {}),
    "YOLOv8, free axes, half precision": (yolo(free=True, half=True, metadata={"imgsz": "[64, 64]"}), {}),
    "YOLOv8, prototypes first": (yolo(reverse=True), {}),
    "YOLOv8, task and end2end stated": (yolo(metadata={"task": "segment", "end2end": "False"}), {}),
    "YOLOv5": (yolo(layout="objectness"), {}),
    "YOLOv5, half precision, free axes": (
        yolo(layout="objectness", free=True, half=True, metadata={"imgsz": "64"}), {},
    ),
    "YOLO26": (yolo(layout="chosen", metadata={"end2end": "True"}), {}),
    "YOLOv8, nms=True": (yolo(layout="chosen", metadata={"args": "{'nms': True}"}), {}),
    "YOLOv8, names of a drill and a rock, table given": (
        yolo(names="{0: 'Bank', 1: 'oyster drill'}"), {"net.eyes.yaml": "classes: {Bank: oyster}"},
    ),
    "logits, water oyster obstacle floor": (semantic(), {}),
    "logits, half precision": (semantic(half=True), {}),
    "logits, free axes": (semantic("w", "h"), {}),
    "probabilities": (semantic(end="shares", names=("input", "output"), metadata={"names": str(NAMES)}), {}),
    "argmax": (semantic(end="classes3", names=("input", "out"), metadata={"names": str(NAMES)}), {}),
    "argmax with a channel": (semantic(end="classes4", names=("input", "out")), {"net.eyes.yaml": OURS}),
    "classes in another order": (
        semantic(order=(3, 1, 0, 2), metadata={"names": "{0: 'sand', 1: 'oyster', 2: 'water', 3: 'rock'}"}), {},
    ),
    "SegFormer": (semantic(names=TRANSFORMERS, imagenet=True, quarter=True), config()),
    "SegFormer, half precision": (semantic(names=TRANSFORMERS, imagenet=True, quarter=True, half=True), config()),
    "SegFormer, its preprocessor stated": (
        semantic(names=TRANSFORMERS, quarter=True),
        config() | {"preprocessor_config.json": json.dumps({"do_normalize": False})},
    ),
    "blue first, stated": (semantic(bgr=True), {"net.eyes.yaml": "channels: bgr"}),
    "normalised as ImageNet, stated": (semantic(imagenet=True), {"net.eyes.yaml": "pixels: imagenet"}),
}  # fmt: skip
"""What people have, with the files beside it."""


@pytest.mark.parametrize("name", LAYOUTS)
def test_every_layout_shows_the_same(tmp_path, name):
    pytest.importorskip("onnxruntime")
    eyes, found = seen(tmp_path, *LAYOUTS[name])
    oysters = np.zeros((48, 64), bool)
    oysters[28:44, 20:40] = True
    wrong = (found.labels == Label.OYSTER) != oysters
    quarter = "SegFormer" in name  # a pixel of the coarse map at the border of the patch
    assert wrong.mean() < (0.05 if quarter else 0.002)
    assert (found.labels[30:42, 22:38] == Label.OYSTER).all()
    assert (found.labels[45:] == Label.SEABED).all()
    assert "oyster" in eyes.about[1]


REFUSED = {
    "boxes alone": (yolo(metadata={"task": "detect"}), {}, "metadata.task: found detect"),
    "names for fewer classes": (yolo(names="{0: 'oyster'}"), {}, r"found 1 x 38 x 2 for 1 classes"),
    "no oyster": (yolo(names="{0: 'oyster drill', 1: 'rock'}"), {}, "NAME.eyes.yaml"),
    "all candidates, end2end stated": (yolo(metadata={"end2end": "True"}), {}, "doubles left out"),
    "another size stated": (yolo(metadata={"imgsz": "[640, 640]"}), {}, "metadata.imgsz: found 640 x 640"),
    "classes without names": (semantic(names=TRANSFORMERS), {}, "none, expected a class"),
    "argmax without names": (semantic(end="classes3"), {}, "none, expected a class"),
    "names of fewer channels": (semantic(metadata={"names": "{0: 'oyster', 1: 'rock'}"}), {}, "4 channels for the"),
    "a table of a class that is not there": (yolo(), {"net.eyes.yaml": "classes: {clam: oyster}"}, "no such class"),
    "metadata and config.json differ": (
        semantic(metadata={"names": "{0: 'oyster'}"}),
        config(),
        "the names in config.json",
    ),
    "YOLO outlines in a semantic layout": (semantic(metadata={"task": "segment"}), {}, "metadata.task: found segment"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_contradicts_itself_is_refused_in_one_line(tmp_path, name):
    pytest.importorskip("onnxruntime")
    content, beside, said = REFUSED[name]
    with pytest.raises(InputError, match=said):
        seen(tmp_path, content, beside)

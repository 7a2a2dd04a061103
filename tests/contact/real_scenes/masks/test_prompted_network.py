"""Networks that segment at a click: a tiny pair of real files, and stand-ins that show what they are asked."""

import dataclasses

import numpy as np
import pytest
from painted_table import BOX, at, overlap, picture

from coral.contact.real_scenes.masks.click_masks import ClickMasks
from coral.contact.real_scenes.masks.mask_registry import MaskSetting, make_masks
from coral.contact.real_scenes.masks.prompted_network import PromptedNetwork
from coral.errors import InputError
from coral.onnx_file import OnnxFile
from onnx_files import prompted_pair


@pytest.fixture
def files(tmp_path):
    """A file for `--masks onnx:`; the click is on the box of `picture(at(0, 0))`."""
    pytest.importorskip("onnxruntime")
    for name, content in zip(("encoder", "decoder"), prompted_pair(192), strict=True):
        (tmp_path / f"{name}.onnx").write_bytes(content)
    _, (truth,) = picture(at(0.0, 0.0))
    row, column = np.argwhere(truth).mean(axis=0)
    path = tmp_path / "sam.yaml"
    path.write_text(f"encoder: encoder.onnx\ndecoder: decoder.onnx\nobjects: {{box: [{column}, {row}]}}\n")
    return path


def test_the_network_makes_the_first_mask_and_depth_follows(files):
    masks = make_masks(f"onnx:{files}", MaskSetting({"box": BOX}))
    assert isinstance(masks, ClickMasks)
    assert masks.wants_colours
    frame, (truth,) = picture(at(0.0, 0.0))
    assert overlap(masks.segment(frame, {})["box"], truth) > 0.7
    moved, (truth,) = picture(at(0.01, 0.0))
    assert overlap(masks.segment(moved, {"box": at(0.0, 0.0)})["box"], truth) > 0.7


def test_a_click_beside_its_mask_is_one_line(files):
    files.write_text(files.read_text().replace("objects: {box: [", "objects: {box: [40.0, 60.0]}\n#"))
    masks = make_masks(f"onnx:{files}", MaskSetting({"box": BOX}))
    with pytest.raises(InputError, match=r"the click of box at 40, 60: found a mask of .* expected a mask around"):
        masks.segment(picture(at(0.0, 0.0))[0], {})


class Network:
    """A network of given shapes; it keeps what it is given."""

    def __init__(self, inputs, outputs, answers):
        self.asked = []
        self.file = OnnxFile("net.onnx", self, inputs, outputs, {})
        self._answers = answers

    def run(self, names, values):
        self.asked.append(values)
        return self._answers


ENCODER = {"images": (1, 3, 64, 64)}
OWN_EXPORT = {
    "image_embeddings": (1, 8, 4, 4),
    "point_coords": (1, None, 2),
    "point_labels": (1, None),
    "mask_input": (1, 1, 16, 16),
    "has_mask_input": (1,),
    "orig_im_size": (2,),
}


def pair(masks, quality=None, decoder=None):
    encoder = Network(ENCODER, {"features": (1, 8, 4, 4)}, [np.ones((1, 8, 4, 4))])
    outputs = {"masks": masks.shape, "iou_predictions": (1, masks.shape[1])}
    answers = [masks, np.zeros((1, masks.shape[1])) if quality is None else quality]
    return encoder, Network(decoder or OWN_EXPORT, outputs, answers)


def test_the_decoder_is_asked_as_its_own_export_wants():
    frame, _ = picture(at(0.0, 0.0))
    height, width = frame.depth.shape
    masks = -np.ones((1, 2, height, width), np.float32)
    masks[0, 1, 5, 7] = 1.0
    encoder, decoder = pair(masks, np.array([[0.2, 0.9]]))
    found = PromptedNetwork(encoder.file, decoder.file).segment(frame, (7, 5))
    assert np.argwhere(found).tolist() == [[5, 7]]  # the mask of the better quality
    (asked,) = decoder.asked
    scale = 64 / width
    assert asked["point_coords"][0, 0] == pytest.approx([7.5 * scale, 5.5 * scale])
    assert asked["point_labels"].tolist() == [[1.0, -1.0]]
    assert asked["orig_im_size"].tolist() == [height, width]
    assert asked["mask_input"].shape == (1, 1, 16, 16)
    tensor = encoder.asked[0]["images"]
    assert tensor.shape == (1, 3, 64, 64)
    assert not tensor[0, :, round(height * scale) :].any()  # padded below


def test_a_decoder_without_the_optional_inputs_is_asked_less():
    small = {name: OWN_EXPORT[name] for name in ("image_embeddings", "point_coords", "point_labels")}
    encoder, decoder = pair(np.ones((1, 1, 16, 16), np.float32), decoder=small)
    frame, _ = picture(at(0.0, 0.0))
    assert PromptedNetwork(encoder.file, decoder.file).segment(frame, (7, 5)).all()
    assert set(decoder.asked[0]) == set(small)


@pytest.mark.parametrize(
    ("encoder", "decoder", "told"),
    [
        ({"images": (1, 4, 64, 64)}, OWN_EXPORT, r"one input of shape \(1, 3, S, S\)"),
        ({"images": (None, None, 3)}, OWN_EXPORT, r"one input of shape \(1, 3, S, S\)"),
        (ENCODER, {"image_embeddings": (1, 8, 4, 4)}, "point_coords"),
        (ENCODER, {**OWN_EXPORT, "high_res_feats_0": (1, 32, 256, 256)}, "at most mask_input"),
    ],
)
def test_a_network_of_another_kind_is_one_line(encoder, decoder, told):
    files = [OnnxFile("net.onnx", None, inputs, {"masks": (1, 1, 8, 8)}, {}) for inputs in (encoder, decoder)]
    with pytest.raises(InputError, match=told):
        PromptedNetwork(*files)


@pytest.mark.parametrize("masks", [np.full((1, 1, 8, 8), np.nan), np.ones((8, 8))])
def test_what_is_no_mask_is_one_line(masks):
    encoder, decoder = pair(np.ones((1, 1, 8, 8)))
    decoder._answers[0] = masks
    with pytest.raises(InputError, match="finite"):
        PromptedNetwork(encoder.file, decoder.file).segment(picture(at(0.0, 0.0))[0], (7, 5))


def test_a_picture_without_colours_is_one_line():
    encoder, decoder = pair(np.ones((1, 1, 8, 8)))
    frame = dataclasses.replace(picture(at(0.0, 0.0))[0], rgb=None)
    with pytest.raises(InputError, match="without colours"):
        PromptedNetwork(encoder.file, decoder.file).segment(frame, (7, 5))


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("objects: {box: [1, 2]}", "expected encoder, decoder, objects"),
        ("encoder: 3\ndecoder: d.onnx\nobjects: {box: [1, 2]}", "encoder: found 3"),
        ("encoder: e.onnx\ndecoder: d.onnx\nobjects: {box: 3}", "objects.box"),
        ("encoder: e.onnx\ndecoder: d.onnx\nobjects: {box: [1, 2]}", "found no file"),
    ],
)
def test_a_broken_file_is_one_line(tmp_path, content, told):
    (tmp_path / "sam.yaml").write_text(content)
    with pytest.raises(InputError, match=told):
        make_masks(f"onnx:{tmp_path / 'sam.yaml'}", MaskSetting({"box": BOX}))

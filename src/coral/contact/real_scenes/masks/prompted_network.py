"""Networks that segment what a click points at, as ONNX files: encoder and decoder of Segment Anything and its kin."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.config import read_yaml
from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.masks.click_masks import Pixel, parse_clicks
from coral.errors import InputError
from coral.onnx_file import OnnxFile, open_onnx

Tensor = NDArray[np.float32]
Mask = NDArray[np.bool_]
MEAN, DEVIATION = (123.675, 116.28, 103.53), (58.395, 57.12, 57.375)
"""Of the colours, 0 to 255, that these networks were trained with (ImageNet's)."""
POINT, PADDING = 1.0, -1.0
"""Labels of prompts: a point of the object, and the point that stands for no box."""
_PROMPTS = ("point_coords", "point_labels")
_OPTIONAL = ("mask_input", "has_mask_input", "orig_im_size")


class PromptedNetwork:
    """Segments what is at a pixel.

    The encoder has one input, the picture of Shape=(1, 3, S, S), scaled so that its longer side is S, normalised, with
    zeros below or to the right; its first output are the features. The decoder has the inputs that Segment
    Anything's own export has: features, `point_coords`, `point_labels`, and if they are there `mask_input`,
    `has_mask_input` and `orig_im_size`; its outputs are `masks` or `low_res_masks`, positive inside, and
    `iou_predictions`, by which the best of several masks is chosen.

    Args:
        encoder: The encoder.
        decoder: The decoder.

    Raises:
        InputError: Their inputs or outputs are others.
    """

    def __init__(self, encoder: OnnxFile, decoder: OnnxFile) -> None:
        shape = encoder.input_shape
        if len(encoder.inputs) != 1 or len(shape) != 4 or shape[1] != 3 or shape[2] is None or shape[2] != shape[3]:
            raise InputError(encoder.path, "inputs", str(dict(encoder.inputs)), "one input of shape (1, 3, S, S)")
        features = [name for name in decoder.inputs if name not in (*_PROMPTS, *_OPTIONAL)]
        missing = [name for name in _PROMPTS if name not in decoder.inputs]
        if len(features) != 1 or missing:
            expected = f"features, {', '.join(_PROMPTS)} and at most {', '.join(_OPTIONAL)}"
            raise InputError(decoder.path, "inputs", ", ".join(decoder.inputs), expected)
        if not {"masks", "low_res_masks"} & set(decoder.outputs):
            raise InputError(decoder.path, "outputs", ", ".join(decoder.outputs), "masks or low_res_masks")
        self._encoder, self._decoder, self._features, self._size = encoder, decoder, features[0], int(shape[2])

    def segment(self, frame: RgbdFrame, pixel: Pixel) -> Mask:
        """Segment what is at a pixel (column, row). Shape=(H, W).

        Raises:
            InputError: The picture has no colours, or a network gives something else than a mask.
        """
        if frame.rgb is None:
            raise InputError("--masks", "", "a picture without colours", "a camera or recording with colours")
        height, width = frame.rgb.shape[:2]
        scale = self._size / max(height, width)
        features = next(iter(self._encoder.run(self._tensor(frame.rgb, scale)).values()))
        prompts = np.array([[[pixel[0] + 0.5, pixel[1] + 0.5], [0.0, 0.0]]], np.float32) * np.float32(scale)
        values = {
            self._features: features,
            "point_coords": prompts,
            "point_labels": np.array([[POINT, PADDING]], np.float32),
            "mask_input": np.zeros((1, 1, self._size // 4, self._size // 4), np.float32),
            "has_mask_input": np.zeros(1, np.float32),
            "orig_im_size": np.array([height, width], np.float32),
        }
        found = self._decoder.run_named({name: values[name] for name in self._decoder.inputs})
        whole = "masks" in found
        masks = found["masks" if whole else "low_res_masks"]
        if masks.ndim != 4 or not np.isfinite(masks).all():
            raise InputError(self._decoder.path, "outputs", f"masks of shape {masks.shape}", "finite, (1, K, H, W)")
        quality = found.get("iou_predictions", np.zeros((1, 1), np.float32)).ravel()
        best = int(quality.argmax()) if len(quality) == masks.shape[1] else 0
        return np.asarray(self._fitted(masks[0, best], scale, (height, width)) > 0.0)

    def _tensor(self, rgb: NDArray[np.uint8], scale: float) -> Tensor:
        height, width = rgb.shape[:2]
        size = (round(width * scale), round(height * scale))
        scaled = cv2.resize(rgb, size, interpolation=cv2.INTER_AREA if scale < 1.0 else cv2.INTER_LINEAR)
        tensor = np.zeros((1, 3, self._size, self._size), np.float32)
        tensor[0, :, : size[1], : size[0]] = ((scaled - np.array(MEAN)) / np.array(DEVIATION)).transpose(2, 0, 1)
        return tensor

    def _fitted(self, mask: Tensor, scale: float, shape: tuple[int, int]) -> Tensor:
        """Return the mask in the picture's size; a mask of another size covers the padded square."""
        if mask.shape == shape:
            return mask
        square = cv2.resize(mask, (self._size, self._size), interpolation=cv2.INTER_LINEAR)
        part = square[: round(shape[0] * scale), : round(shape[1] * scale)]
        return np.asarray(cv2.resize(part, (shape[1], shape[0]), interpolation=cv2.INTER_LINEAR))


def read_prompted_network(path: Path) -> tuple[PromptedNetwork, dict[str, Pixel]]:
    """Read a file with `encoder`, `decoder` (ONNX files beside it) and `objects`, the clicks.

    Raises:
        InputError: The file, or one that it names, is missing or broken.
    """
    content = read_yaml(path)
    if set(content) != {"encoder", "decoder", "objects"}:
        found = ", ".join(map(str, content)) or "nothing"
        raise InputError(str(path), "", found, "encoder, decoder, objects")
    for key in ("encoder", "decoder"):
        if not isinstance(content[key], str):
            raise InputError(str(path), key, repr(content[key])[:40], "the path of an ONNX file")
    clicks = parse_clicks(content["objects"], path)
    encoder, decoder = (open_onnx(path.parent / content[key], "--masks") for key in ("encoder", "decoder"))
    return PromptedNetwork(encoder, decoder), clicks

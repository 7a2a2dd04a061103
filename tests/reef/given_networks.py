"""Networks without a file: outputs that are given by hand."""

import numpy as np

from coral.onnx_file import OnnxFile


class GivenSession:
    def __init__(self, outputs):
        self.outputs, self.fed = outputs, None

    def run(self, names, feeds):
        self.fed = next(iter(feeds.values()))
        return list(self.outputs.values())


def given(outputs, size=(4, 2), channels=3, metadata=None):
    """A network for pictures of a width and height whose outputs are always these."""
    shapes = {name: value.shape for name, value in outputs.items()}
    inputs = {"picture": (1, channels, size[1], size[0])}
    return OnnxFile("net.onnx", GivenSession(outputs), inputs, shapes, metadata or {})


def one_hot(labels):
    """Logits that are sure of some labels. Shape=(H, W) to (1, 4, H, W)."""
    labels = np.asarray(labels)
    return np.stack([np.where(labels == k, 9.0, 0.0) for k in range(4)])[None].astype(np.float32)

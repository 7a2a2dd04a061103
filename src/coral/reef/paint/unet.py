"""Our own network: a small U-Net on half-size features, with heads for classes, depth and the depth's doubt.

Needs torch, which only training uses: nothing else imports this module.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional

CLASSES = 4
FLAT_PER_M = 1.0 / 12.0
"""Inverse depth (1/m) that stands for all that is flatter: the horizon, and open water."""
_WIDTHS = (24, 40, 64, 96)


def _block(inputs: int, outputs: int) -> nn.Sequential:
    layers: list[nn.Module] = []
    for first in (inputs, outputs):
        layers += [nn.Conv2d(first, outputs, 3, padding=1, bias=False), nn.BatchNorm2d(outputs), nn.ReLU()]
    return nn.Sequential(*layers)


class ReefNet(nn.Module):  # type: ignore[misc]  # torch is not there when types are checked
    """Maps `network_input` to classes and metric depth.

    Pixels are rearranged into 2 x 2 blocks first (space to depth), so that all convolutions run at half size or less:
    a quarter of the work. The depth head corrects the depth of the flat sea floor, which the input holds, in logarithm.
    """

    def __init__(self) -> None:
        super().__init__()
        a, b, c, d = _WIDTHS
        self.down = nn.ModuleList([_block(16, a), _block(a, b), _block(b, c), _block(c, d)])
        self.up = nn.ModuleList([_block(d + c, c), _block(c + b, b), _block(b + a, a)])
        self.head = nn.Conv2d(a, 4 * (CLASSES + 2), 1)

    def forward(self, picture: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Return (logits (N, 4, H, W), depth in m (N, 1, H, W), relative doubt of the depth (N, 1, H, W)).

        Args:
            picture: Shape (N, 4, H, W); H and W are multiples of 16.
        """
        x = functional.pixel_unshuffle(picture, 2)
        kept: list[Tensor] = []
        for level, block in enumerate(self.down):
            x = block(x if level == 0 else functional.max_pool2d(x, 2))
            kept.append(x)
        for block, beside in zip(self.up, kept[-2::-1], strict=True):
            size = (beside.shape[2], beside.shape[3])
            x = block(torch.cat([functional.interpolate(x, size=size, mode="nearest"), beside], dim=1))
        out = functional.pixel_shuffle(self.head(x), 2)
        flat = -torch.log(torch.clamp(picture[:, 3:4], min=FLAT_PER_M))
        depth = torch.exp(flat + out[:, CLASSES : CLASSES + 1])
        return out[:, :CLASSES], depth, functional.softplus(out[:, CLASSES + 1 :]) + 0.01

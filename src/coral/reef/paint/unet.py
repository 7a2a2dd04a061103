"""Our own network: a small U-Net with heads for classes, depth and the depth's doubt, and a measure of the unfamiliar.

Needs torch, which only training uses: nothing else imports this module.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional

CLASSES = 4
FLAT_PER_M = 1.0 / 12.0
"""Inverse depth (1/m) that stands for all that is flatter: the horizon, and open water."""
STRIDE = 2
"""Height and width of a picture are multiples of this (px)."""
AXES, CENTRES = 96, 512
_STAGES = ((1, 3, 1, 1, 16), (6, 3, 2, 2, 24), (6, 5, 2, 2, 40), (6, 3, 2, 3, 80), (6, 5, 1, 3, 112), (6, 5, 2, 4, 192))
"""EfficientNet-Lite0 (Tan and Le 2019, arXiv 1905.11946) without its last stage: how much wider a block is inside, its
kernel, its first stride, number of blocks, channels."""
_WIDTHS = (16, 32, 64, 96)
"""Channels on the way up, from half size to a sixteenth."""


def _unit(inputs: int, outputs: int, kernel: int, stride: int = 1, groups: int = 1) -> list[nn.Module]:
    return [
        nn.Conv2d(inputs, outputs, kernel, stride, padding=kernel // 2, groups=groups, bias=False),
        nn.BatchNorm2d(outputs, eps=1e-3, momentum=0.01),
    ]


class _Block(nn.Module):  # type: ignore[misc]
    """An inverted residual."""

    def __init__(self, inputs: int, outputs: int, wider: int, kernel: int, stride: int) -> None:
        super().__init__()
        inside = inputs * wider
        widen = [*_unit(inputs, inside, 1), nn.ReLU6()] if wider > 1 else []
        self.body = nn.Sequential(
            *widen, *_unit(inside, inside, kernel, stride, inside), nn.ReLU6(), *_unit(inside, outputs, 1)
        )
        self.adds = stride == 1 and inputs == outputs

    def forward(self, x: Tensor) -> Tensor:
        return x + self.body(x) if self.adds else self.body(x)


def _conv(inputs: int, outputs: int) -> nn.Sequential:
    return nn.Sequential(nn.Conv2d(inputs, outputs, 3, padding=1, bias=False), nn.BatchNorm2d(outputs), nn.ReLU())


class ReefNet(nn.Module):  # type: ignore[misc]  # torch is not there when types are checked
    """Maps `network_input` to classes, metric depth, and how unlike the pictures of the training this one is.

    The encoder is EfficientNet-Lite0, whose weights have seen the photographs of ImageNet; colours are evened out
    before it. On the way up, features are added to those of the way down. The depth head corrects the depth of the
    flat sea floor, which the input holds, in logarithm. `sharpness` and `lean` are set after training, so that
    probabilities hold on videos left out of it.

    A picture's descriptor is the mean of its coarsest features, at length 1. `unlike` is its distance to the nearest
    of some hundred descriptors, of real pictures and of painted reefs, in units of a limit (`familiar.py`).
    """

    def __init__(self) -> None:
        super().__init__()
        levels: list[list[nn.Module]] = [[*_unit(4, 32, 3, 2), nn.ReLU6()]]
        channels, sizes = 32, []
        for wider, kernel, stride, count, outputs in _STAGES:
            if stride == 2:
                sizes.append(channels)
                levels.append([])
            for k in range(count):
                levels[-1].append(_Block(channels, outputs, wider, kernel, stride if k == 0 else 1))
                channels = outputs
        self.down = nn.ModuleList([nn.Sequential(*level) for level in levels])
        a, b, c, d = _WIDTHS
        self.context = nn.Linear(channels, channels)
        self.narrow = nn.ModuleList([nn.Conv2d(x, y, 1) for x, y in ((channels, d), (d, c), (c, b), (b, a))])
        self.beside = nn.ModuleList([nn.Conv2d(x, y, 1) for x, y in zip(sizes[::-1], (d, c, b, a), strict=True)])
        self.up = nn.ModuleList([_conv(x, x) for x in (d, c, b, a)])
        self.head = nn.Conv2d(a, 4 * (CLASSES + 2), 1)
        self.register_buffer("sharpness", torch.ones(1))
        self.register_buffer("lean", torch.zeros(CLASSES))
        self.register_buffer("middle", torch.zeros(channels))
        self.register_buffer("axes", torch.zeros(channels, AXES))
        self.register_buffer("centres", torch.zeros(2, CENTRES, AXES))
        self.register_buffer("limits", torch.ones(2))

    def forward(self, picture: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Return logits (N, 4, H, W), depth in m (N, 1, H, W), its relative doubt (N, 1, H, W), unlike (N, 2).

        `picture` has Shape (N, 4, H, W); H and W are multiples of `STRIDE`.
        """
        out, descriptor = self.features(picture)
        flat = -torch.log(torch.clamp(picture[:, 3:4], min=FLAT_PER_M))
        depth = torch.exp(flat + out[:, CLASSES : CLASSES + 1])
        doubt = functional.softplus(out[:, CLASSES + 1 :]) + 0.01
        return self.calibrated(out[:, :CLASSES]), depth, doubt, self.unlike(descriptor)

    def calibrated(self, logits: Tensor) -> Tensor:
        """Return logits sharpened and leant as calibrated."""
        return logits * self.sharpness + self.lean[:, None, None]

    def features(self, picture: Tensor) -> tuple[Tensor, Tensor]:
        """Return the raw output (N, 6, H, W) and the picture's descriptor (N, D)."""
        x = torch.cat([self._evened(picture[:, :3]), picture[:, 3:]], dim=1)
        kept: list[Tensor] = []
        for block in self.down:
            x = block(x)
            kept.append(x)
        mean = x.mean(dim=(2, 3))
        x = x + self.context(mean)[:, :, None, None]
        for narrow, beside, block, fine in zip(self.narrow, self.beside, self.up, kept[-2::-1], strict=True):
            twice = functional.interpolate(narrow(x), scale_factor=2.0, mode="nearest")
            x = block(twice[:, :, : fine.shape[2], : fine.shape[3]] + beside(fine))
        return functional.pixel_shuffle(self.head(x), 2), functional.normalize(mean)

    def _evened(self, light: Tensor) -> Tensor:
        """Return colours with the same mean and spread in every picture and channel: water and lamps differ."""
        apart = light - light.mean(dim=(2, 3), keepdim=True)
        return 0.45 * apart / (torch.sqrt((apart**2).mean(dim=(2, 3), keepdim=True)) + 0.05)

    def begin_with(self, pretrained: dict[str, Tensor]) -> None:
        """Take the encoder's weights from an EfficientNet-Lite0 that was trained to name what photographs show.

        Both have their layers in one order. The floor's depth, a fourth channel, begins with no weight.
        """
        theirs = [value for name, value in pretrained.items() if not name.endswith("num_batches_tracked")]
        mine = [value for name, value in self.down.state_dict().items() if not name.endswith("num_batches_tracked")]
        with torch.no_grad():
            for target, value in zip(mine, theirs, strict=False):
                target.zero_()
                target[:, : value.shape[1]].copy_(value) if target.dim() == 4 else target.copy_(value)

    def unlike(self, descriptor: Tensor) -> Tensor:
        """Return how far descriptors (N, D) are from real pictures and from painted reefs, in units of the limits."""
        at = (descriptor - self.middle) @ self.axes
        apart = torch.stack([torch.sqrt(_squares(at, self.centres[k]).min(dim=1).values) for k in range(2)], dim=1)
        return apart / self.limits


def _squares(at: Tensor, centres: Tensor) -> Tensor:
    """Return the squared distances of points (N, A) to centres (K, A). Shape (N, K)."""
    squares = (at * at).sum(dim=1, keepdim=True) - 2.0 * at @ centres.T + (centres**2).sum(dim=1)
    return torch.clamp(squares, min=0.0)

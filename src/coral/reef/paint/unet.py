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
_WIDTHS = (16, 32, 64, 128, 160)
AXES, CENTRES = 48, 512


def _conv(inputs: int, outputs: int, stride: int = 1) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, 3, stride=stride, padding=1, bias=False), nn.BatchNorm2d(outputs), nn.ReLU()
    )


class ReefNet(nn.Module):  # type: ignore[misc]  # torch is not there when types are checked
    """Maps `network_input` to classes, metric depth, and how unlike the pictures of the training this one is.

    Pixels are rearranged into 2 x 2 blocks first (space to depth), so that all convolutions run at half size or less.
    On the way up, features are added to those of the way down. The depth head corrects the depth of the flat sea floor,
    which the input holds, in logarithm. `sharpness` and `lean` are set after training, so that probabilities hold on
    videos left out of it.

    A picture's descriptor is the mean and the spread of its coarsest features. `unlike` is its distance to the nearest
    of some hundred descriptors, of real pictures and of painted reefs, in units of a limit (`familiar.py`).
    """

    def __init__(self) -> None:
        super().__init__()
        a, b, c, d, e = _WIDTHS
        self.down = nn.ModuleList(
            [
                _conv(16, a),
                nn.Sequential(_conv(a, b, 2), _conv(b, b)),
                nn.Sequential(_conv(b, c, 2), _conv(c, c)),
                nn.Sequential(_conv(c, d, 2), _conv(d, d), _conv(d, d)),
                nn.Sequential(_conv(d, e, 2), _conv(e, e)),
            ]
        )
        self.narrow = nn.ModuleList([nn.Conv2d(x, y, 1) for x, y in ((e, d), (d, c), (c, b), (b, a))])
        self.up = nn.ModuleList([_conv(x, x) for x in (d, c, b, a)])
        self.context = nn.Linear(e, e)
        self.head = nn.Conv2d(a, 4 * (CLASSES + 2), 1)
        self.register_buffer("sharpness", torch.ones(1))
        self.register_buffer("lean", torch.zeros(1))
        self.register_buffer("middle", torch.zeros(2 * e))
        self.register_buffer("axes", torch.zeros(2 * e, AXES))
        self.register_buffer("centres", torch.zeros(2, CENTRES, AXES))
        self.register_buffer("limits", torch.ones(2))

    def forward(self, picture: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Return (logits (N, 4, H, W), depth in m (N, 1, H, W), its relative doubt (N, 1, H, W), unlike (N, 2)).

        Args:
            picture: Shape (N, 4, H, W); H and W are multiples of `STRIDE`.
        """
        out, descriptor = self.features(picture)
        flat = -torch.log(torch.clamp(picture[:, 3:4], min=FLAT_PER_M))
        depth = torch.exp(flat + out[:, CLASSES : CLASSES + 1])
        doubt = functional.softplus(out[:, CLASSES + 1 :]) + 0.01
        return self.calibrated(out[:, :CLASSES]), depth, doubt, self.unlike(descriptor)

    def calibrated(self, logits: Tensor) -> Tensor:
        """Return logits whose odds of oyster against all else are sharpened and leant as calibrated."""
        oyster, others = logits[:, 1:2], torch.cat([logits[:, :1], logits[:, 2:]], dim=1)
        odds = self.sharpness * (oyster - torch.logsumexp(others, dim=1, keepdim=True)) + self.lean
        scaled = others * self.sharpness
        oyster = odds + torch.logsumexp(scaled, dim=1, keepdim=True)
        return torch.cat([scaled[:, :1], oyster, scaled[:, 1:]], dim=1)

    def features(self, picture: Tensor) -> tuple[Tensor, Tensor]:
        """Return the raw output (N, 6, H, W) and the picture's descriptor (N, D)."""
        x = functional.pixel_unshuffle(picture, 2)
        kept: list[Tensor] = []
        for block in self.down:
            x = block(x)
            kept.append(x)
        mean = x.mean(dim=(2, 3))
        spread = torch.sqrt(((x - mean[:, :, None, None]) ** 2).mean(dim=(2, 3)) + 1e-6)
        x = x + self.context(mean)[:, :, None, None]
        for narrow, block, beside in zip(self.narrow, self.up, kept[-2::-1], strict=True):
            twice = functional.interpolate(narrow(x), scale_factor=2.0, mode="nearest")
            x = block(twice[:, :, : beside.shape[2], : beside.shape[3]] + beside)
        return functional.pixel_shuffle(self.head(x), 2), torch.cat([mean, spread], dim=1)

    def unlike(self, descriptor: Tensor) -> Tensor:
        """Return how far descriptors (N, D) are from real pictures and from painted reefs, in units of the limits."""
        at = (descriptor - self.middle) @ self.axes
        apart = torch.stack([torch.sqrt(_squares(at, self.centres[k]).min(dim=1).values) for k in range(2)], dim=1)
        return apart / self.limits


def _squares(at: Tensor, centres: Tensor) -> Tensor:
    """Return the squared distances of points (N, A) to centres (K, A). Shape (N, K)."""
    squares = (at * at).sum(dim=1, keepdim=True) - 2.0 * at @ centres.T + (centres**2).sum(dim=1)
    return torch.clamp(squares, min=0.0)

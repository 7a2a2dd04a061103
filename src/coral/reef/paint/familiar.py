"""What a network should not be sure of: pictures unlike those of its training, and oysters in videos left out of it."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from coral.reef.eyes.ground_plane import ground_depth, network_input
from coral.reef.eyes.reef_net import network_size
from coral.reef.paint.labelled_pictures import LabelledPicture
from coral.reef.paint.score import video_rows
from coral.reef.paint.teaching import PaintedReefs
from coral.reef.paint.unet import AXES, CENTRES, ReefNet
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Label

KEPT = 0.9
"""Real pictures: the share of those of a video left out that the limit keeps. A looser one takes kelp for a reef."""
NEARER = 0.9
"""A picture is taken for painted if painted reefs are nearer than this share of the distance to real pictures. In ten
networks the share is at most 0.92 for painted reefs, and at least 0.96 in the videos left out."""
_FAR = 1e4
SHARPNESS, LEAN = 0.63, -0.21
"""What the logits of oysters are multiplied by and added to: fitted to ten networks, each on the videos left out of its
training, because a network is surer of a place that it has not seen than it should be."""
OYSTER_FROM = 0.35
"""Probability, so corrected, from which a pixel is an oyster: the best IoU of the videos left out."""


def describe_picture(net: ReefNet, picture: NDArray[np.floating]) -> NDArray[np.float32]:
    """Return the descriptor of a picture, of `network_input`. Shape=(4, H, W) to (1, D)."""
    with torch.no_grad():
        return np.asarray(net.features(torch.from_numpy(picture[None].astype(np.float32)))[1].numpy())


def know_training(net: ReefNet, real: list[LabelledPicture], reefs: tuple[PaintedReefs, ...], seed: int) -> None:
    """Let a network remember the pictures that it was trained on; see `remember`."""
    of_painted = [
        describe_picture(net, np.concatenate([part.rgb[k].transpose(2, 0, 1) / 127.5 - 1.0, part.floor[k][None]]))
        for part in reefs
        for k in range(0, len(part.rgb), max(1, 2 * len(part.rgb) // CENTRES))
    ]
    empty = np.zeros((0, net.middle.numel()), np.float32)
    remember(
        net,
        np.concatenate([empty, *_describe_real(net, real)]),
        np.array(2 * [one.video for one in real], np.str_),
        np.concatenate([empty, *of_painted]),
        seed,
    )


def know_more(net: ReefNet, real: list[LabelledPicture], seed: int) -> None:
    """Let a network whose encoder stayed as it was remember some more real pictures, in place of others."""
    rng = np.random.default_rng([seed, 0xFB])
    found = _describe_real(net, real)
    if found:
        at = (torch.from_numpy(np.concatenate(found)) - net.middle) @ net.axes
        some = rng.permutation(len(at))[: CENTRES // 2]
        net.centres[0, rng.permutation(CENTRES)[: len(some)]] = at[some]


def _describe_real(net: ReefNet, real: list[LabelledPicture]) -> list[NDArray[np.float32]]:
    """Describe all pictures as they are, then all as a small camera would take them."""
    whole = [one.rgb for one in real]
    small = [np.asarray(cv2.resize(rgb, (160, 120), interpolation=cv2.INTER_AREA), np.uint8) for rgb in whole]
    return [describe_picture(net, picture_input(rgb)) for rgb in (*whole, *small)]


def picture_input(rgb: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Return a picture as eyes show it to a network, by a camera 1 m above the floor. Shape=(H, W, 3) to (4, h, w)."""
    camera = CameraCfg(width=rgb.shape[1], height=rgb.shape[0])
    size = network_size(camera)
    small = np.asarray(cv2.resize(rgb, size, interpolation=cv2.INTER_AREA), np.uint8)
    return network_input(small, ground_depth(CameraCfg(width=size[0], height=size[1])))


def remember(
    net: ReefNet, real: NDArray[np.float32], videos: NDArray[np.str_], painted: NDArray[np.float32], seed: int
) -> None:
    """Give a network the descriptors of what it was trained on, and the limit.

    Distances are measured along the principal axes of all descriptors, each scaled to the fourth root of its variance.
    This is a nearest-neighbour test (Sun et al. 2022, arXiv 2204.06507). `real`, Shape=(N, D), and `painted`,
    Shape=(M, D), are descriptors; the limit comes from those of one of the videos, Shape=(N,), against all others.
    """
    rng = np.random.default_rng([seed, 0xFA])
    both = np.concatenate([real, painted])
    middle = both.mean(axis=0)
    spread = (both - middle).std(axis=0) + 1e-6
    _, sizes, across = np.linalg.svd((both - middle) / spread, full_matrices=False)
    count = min(AXES, len(sizes))
    axes = np.zeros((both.shape[1], AXES))
    axes[:, :count] = across[:count].T / spread[:, None] / np.sqrt(sizes[:count] / np.sqrt(len(both)) + 1e-6)
    at = [(part - middle) @ axes for part in (real, painted)]
    limit = float(np.quantile(left_out_distances(at[0], videos), KEPT)) if len(set(videos)) > 1 else 1.0
    centres = np.full((2, CENTRES, AXES), _FAR)
    for k, points in enumerate(at):
        if len(points):
            centres[k] = points[rng.permutation(len(points))[np.arange(CENTRES) % len(points)]]
    values = {"middle": middle, "axes": axes, "centres": centres, "limits": np.array([limit, NEARER * limit])}
    net.load_state_dict({**net.state_dict(), **{k: torch.from_numpy(v).float() for k, v in values.items()}})


def left_out_distances(points: NDArray[np.float64], groups: NDArray[np.str_]) -> NDArray[np.float64]:
    """Return the distance of each point to the nearest one of another group. Shape=(N, A) and (N,) to (N,)."""
    squares = ((points[:, None] - points[None]) ** 2).sum(axis=2)
    squares[groups[:, None] == groups[None]] = np.inf
    return np.asarray(np.sqrt(squares.min(axis=1)))


def correct_odds(net: ReefNet) -> None:
    """Make a network as sure as such networks have been right on videos left out."""
    net.sharpness[:], net.lean[int(Label.OYSTER)] = SHARPNESS, LEAN


def measure_left_out(net: ReefNet, pictures: list[LabelledPicture]) -> list[dict[str, Any]]:
    """Return the rows of `video_rows`. A pixel counts as oyster from a probability of `OYSTER_FROM`."""
    return video_rows(_seen(net, one) for one in pictures)


def _seen(net: ReefNet, one: LabelledPicture) -> tuple[LabelledPicture, NDArray[np.bool_], NDArray[np.float32]]:
    with torch.no_grad():
        logits = net(torch.from_numpy(picture_input(one.rgb)[None]))[0][0]
    likely = torch.softmax(logits, dim=0)[int(Label.OYSTER)].numpy()
    return one, likely > OYSTER_FROM, likely

"""Trains `ReefNet` on a set of samples and exports it as ONNX. Needs torch and onnx (extra `train`)."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from pickle import UnpicklingError

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from coral.config import Count, Positive
from coral.errors import InputError
from coral.reef.paint.unet import ReefNet
from coral.reef.world.geometry import Label

_NEAREST_M, _FARTHEST_M = 0.1, 12.0


@dataclass(frozen=True, kw_only=True)
class TrainingCfg:
    """How long and how fast."""

    epochs: Count = 24
    batch: Count = 4
    rate: Positive = 2e-3
    """Largest learning rate: reached after a twentieth of the training, then falling along a cosine to 0."""
    oyster_weight: Positive = 2.0
    """Weight of oyster pixels in the cross entropy: they are few."""
    overlap_weight: Positive = 1.0
    """Weight of 1 - IoU of the oysters, which the cross entropy of few pixels hardly feels."""
    obstacle_weight: Positive = 2.0
    """The same for obstacles: to miss one is worse than to see one too many."""
    threads: Count = 2
    limit_s: Positive = 7200.0
    """Wall time after which training ends early. The learning rate falls faster if this comes before the last epoch;
    the result then depends on the speed of the machine."""


@dataclass(frozen=True)
class TrainingData:
    """N pictures with what is true of them, as compact arrays."""

    pictures: NDArray[np.float16]
    """Of `network_input`. Shape=(N, 4, H, W)."""
    labels: NDArray[np.uint8]
    """Shape=(N, H, W)."""
    depth: NDArray[np.float16]
    """Metres, inf for water. Shape=(N, H, W)."""


def train(
    data: TrainingData,
    cfg: TrainingCfg,
    seed: int,
    tell: Callable[[str], None] = print,
    begin: dict[str, Tensor] | None = None,
) -> ReefNet:
    """Train a network.

    The loss is cross entropy of the classes (weighted), 1 - IoU of the oysters with probabilities for pixels, and the
    negative logarithm of a Laplace density of the depth's logarithm, whose width the network states as its doubt.

    Args:
        data: What to learn from.
        cfg: How long and how fast.
        seed: Of the first weights, the order and the variation of colours.
        tell: Called with a line after each epoch.
        begin: Weights to begin with, of `weights_in`; random ones by default.
    """
    torch.set_num_threads(cfg.threads)
    torch.manual_seed(seed)
    rng = np.random.default_rng([seed, 0x7A])
    net: ReefNet = ReefNet().to(memory_format=torch.channels_last)
    if begin is not None:
        net.load_state_dict(begin)
    optimizer = torch.optim.AdamW(net.parameters(), lr=cfg.rate, weight_decay=1e-3)
    batches = len(data.labels) // cfg.batch
    weight = torch.ones(len(Label))
    weight[Label.OYSTER], weight[Label.OBSTACLE] = cfg.oyster_weight, cfg.obstacle_weight
    begun, done = time.monotonic(), 0
    for epoch in range(cfg.epochs):
        net.train()
        order, total = rng.permutation(len(data.labels)), np.zeros(3)
        for start in range(0, batches * cfg.batch, cfg.batch):
            progress = max(done / (batches * cfg.epochs), (time.monotonic() - begun) / cfg.limit_s)
            if progress >= 1.0:
                break
            optimizer.param_groups[0]["lr"] = cfg.rate * _rate_at(progress)
            done += 1
            picture, labels, depth = _batch(data, np.sort(order[start : start + cfg.batch]), rng)
            logits, metres, doubt = net(picture)
            classes = functional.cross_entropy(logits, labels, weight=weight)
            overlap = _overlap_loss(logits, labels)
            distance = _distance_loss(metres, doubt, depth)
            optimizer.zero_grad(set_to_none=True)
            (classes + cfg.overlap_weight * overlap + 0.3 * distance).backward()
            optimizer.step()
            total += (float(classes.detach()), float(overlap.detach()), float(distance.detach()))
        steps, took = max(done - epoch * batches, 1), time.monotonic() - begun
        classes_mean, overlap_mean, depth_mean = total / steps
        tell(
            f"epoch {epoch + 1}: classes {classes_mean:.3f}, oysters 1 - IoU {overlap_mean:.3f}, "
            f"depth {depth_mean:.3f}, {took:.0f} s"
        )
        if took >= cfg.limit_s:
            break
    net.eval()
    return net


def weights_in(path: Path) -> dict[str, Tensor]:
    """Read the weights that `export` wrote beside an ONNX file.

    Raises:
        InputError: The file holds no weights of this network.
    """
    expected = "weights of our network, as `coral reef eyes train` writes them beside FILE.onnx"
    try:
        weights = torch.load(path, map_location="cpu", weights_only=True)
        ReefNet().load_state_dict(weights)
    except (OSError, EOFError, RuntimeError, TypeError, AttributeError, UnpicklingError) as error:
        raise InputError("--begin", "", f"{path}: {' '.join(str(error).split())[:80]}", expected) from None
    else:
        found: dict[str, Tensor] = weights
        return found


def export(net: ReefNet, path: Path, size: tuple[int, int] = (160, 120)) -> None:
    """Write a network as ONNX: input `picture`, outputs `logits`, `depth`, `depth_doubt`; its weights as .pt beside.

    Args:
        net: The network.
        path: Where to.
        size: Width and height of its pictures (px).
    """
    width, height = size
    torch.save(net.state_dict(), path.with_suffix(".pt"))
    torch.onnx.export(
        net,
        (torch.zeros(1, 4, height, width),),
        str(path),
        input_names=["picture"],
        output_names=["logits", "depth", "depth_doubt"],
        opset_version=17,
        dynamo=False,
    )


def _rate_at(progress: float) -> float:
    """Return the share of the largest learning rate at a share of the training."""
    return min(progress / 0.05, 0.5 + 0.5 * math.cos(math.pi * min(progress, 1.0)))


def _overlap_loss(logits: Tensor, labels: Tensor) -> Tensor:
    """Return 1 - IoU of the oysters of a batch, with probabilities in place of pixels (soft Jaccard loss)."""
    likely = functional.softmax(logits, dim=1)[:, int(Label.OYSTER)]
    true = (labels == int(Label.OYSTER)).to(likely.dtype)
    both = (likely * true).sum()
    return 1.0 - (both + 1.0) / ((likely + true).sum() - both + 1.0)


def _distance_loss(metres: Tensor, doubt: Tensor, depth: Tensor) -> Tensor:
    """Laplace loss of the logarithm of the depth, where there is something to see."""
    there = torch.isfinite(depth)
    true = torch.log(torch.clamp(depth[there], _NEAREST_M, _FARTHEST_M))
    error = (torch.log(metres[:, 0][there]) - true).abs()
    width = doubt[:, 0][there]
    return (error / width + torch.log(width)).mean()


def _batch(data: TrainingData, chosen: NDArray[np.intp], rng: np.random.Generator) -> tuple[Tensor, Tensor, Tensor]:
    """Return some pictures: half of them mirrored, with other colours, contrast and noise."""
    picture = data.pictures[chosen].astype(np.float32)
    labels, depth = data.labels[chosen].astype(np.int64), data.depth[chosen].astype(np.float32)
    mirrored = rng.random(len(chosen)) < 0.5
    for array in (picture, labels, depth):
        array[mirrored] = array[mirrored][..., ::-1]
    shape = (len(chosen), 3, 1, 1)
    light = (picture[:, :3] + 1.0) / 2.0
    light = light ** rng.uniform(0.7, 1.4, (len(chosen), 1, 1, 1)) * rng.uniform(0.8, 1.25, shape)
    light += rng.normal(0.0, 1.0, light.shape) * rng.uniform(0.0, 0.03, (len(chosen), 1, 1, 1))
    picture[:, :3] = np.clip(light, 0.0, 1.0) * 2.0 - 1.0
    return (
        torch.from_numpy(picture).contiguous(memory_format=torch.channels_last),
        torch.from_numpy(labels),
        torch.from_numpy(depth),
    )

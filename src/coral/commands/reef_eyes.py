"""`coral reef eyes`: train a network for the reef, or measure how well one sees."""

from __future__ import annotations

import itertools
import math
import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np

from coral.config import Count, Positive
from coral.errors import InputError
from coral.flags import Argument
from coral.run_files import SurveyFiles

if TYPE_CHECKING:
    from coral.reef.vehicle.camera import CameraCfg
    from coral.reef.world.geometry import Frame


@dataclass(frozen=True, kw_only=True)
class ReefEyes:
    """Train our network on pictures of generated reefs, or score eyes on pictures whose truth is known."""

    action: Annotated[Literal["train", "score", "calibrate"], Argument()]
    """train: write --out FILE.onnx; needs the extra `train`. score: overlap of classes and error of depth by range.
    calibrate: measure on runs how much true cover its votes stand for; write --out FILE.cover.json."""
    perception: str = "rgb"
    """score, calibrate: rgb or FILE.onnx."""
    runs: tuple[Path, ...] = ()
    """calibrate: runs in simulated reefs, with colour pictures (--cfg.simulator.pictures)."""
    worlds: tuple[str, ...] = ("all",)
    """score: reefs to take pictures of; `all` are the ten shipped ones, on which nothing is trained."""
    waters: tuple[str, ...] = ("clear", "1C", "bay")
    """score: waters of these pictures."""
    lights: tuple[str, ...] = ("day",)
    """score: light of these pictures: day, low-sun, overcast, dim."""
    pictures: Count = 6
    """Pictures of each reef (and water)."""
    labelled: tuple[Path, ...] = ()
    """train: folders of real pictures with oysters marked: YOLO or Roboflow, COCO, masks, CoralNet's points."""
    oysters: tuple[str, ...] = ()
    """train: names (or numbers) of the classes there that are oysters; all of them, by default."""
    without: tuple[str, ...] = ()
    """train: videos that are left out, and measured: names of pictures without the number of the frame."""
    reefs: Count = 75
    """train: generated reefs."""
    steps: Count = 3000
    """train: steps, of some 50 or 100 pictures each."""
    batch: Count = 48
    """train: pictures of a step."""
    device: Literal["cpu", "cuda"] = "cpu"
    """train: cuda for a graphics card."""
    limit_s: Positive = 7200.0
    """train: longest time."""
    begin: Path | None = None
    """train: weights to begin with, whose encoder stays as it is: FILE.pt of an earlier training, or rgb, the shipped
    network. By default the encoder has seen photographs, and learns as well."""
    threads: Count = 2
    """train: threads of torch."""
    out: Path | None = None
    """train: the file to write."""
    seed: int = 0
    """Of all random numbers."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        """Train or score."""
        if self.seed < 0:
            raise InputError("--seed", "", self.seed, "a number of 0 or more")
        actions = {"train": self._train, "score": self._score, "calibrate": self._calibrate}
        return actions[self.action]()

    def _train(self) -> Mapping[str, Any]:
        if self.out is None or self.out.suffix != ".onnx" or self.out.exists():
            raise InputError("--out", "", str(self.out), "a new file that ends in .onnx")
        try:
            from coral.reef.paint.training import TrainingCfg, export, train, weights_in
        except ImportError as error:
            raise InputError("coral reef eyes train", "", f"no package {error.name}", "the extra `train`") from None
        from coral.reef.eyes.reef_net import WEIGHTS
        from coral.reef.paint.familiar import know_more, know_training
        from coral.reef.paint.labelled_pictures import read_labelled
        from coral.reef.paint.left_out import OYSTER_FROM, correct_odds, measure_left_out
        from coral.reef.paint.teaching import gather_real, teach

        begin = None if self.begin is None else weights_in(WEIGHTS if str(self.begin) == "rgb" else self.begin)
        marked = [one for folder in self.labelled for one in read_labelled(folder, self.oysters)]
        unknown = set(self.without) - {one.video for one in marked}
        if unknown:
            raise InputError("--without", "", sorted(unknown)[0], ", ".join(sorted({one.video for one in marked})))
        kept = [one for one in marked if one.video not in self.without]
        data = teach(
            self.seed, reefs=self.reefs, pictures=self.pictures, real=gather_real(kept), processes=self.threads,
            tell=_tell,
        )  # fmt: skip
        cfg = TrainingCfg(
            rate=6e-4 if begin else 3e-3,
            steps=self.steps,
            batch=self.batch,
            limit_s=self.limit_s,
            threads=self.threads,
            device=self.device,
        )
        net = train(data, cfg, self.seed, _tell, begin)
        if begin is None:
            know_training(net, kept, data.reefs, self.seed)
        else:
            know_more(net, kept, self.seed)
        correct_odds(net)
        self.out.parent.mkdir(parents=True, exist_ok=True)
        export(net, self.out, OYSTER_FROM)
        rows = measure_left_out(net, [one for one in marked if one.video in self.without])
        return {"file": str(self.out), "pictures": 2 * self.reefs * self.pictures, "real": len(kept), "rows": rows}

    def _calibrate(self) -> Mapping[str, Any]:
        from coral.reef.eyes.backends import open_eyes
        from coral.reef.products.calibrate_cover import calibrate, gather_evidence, leave_one_out
        from coral.reef.products.cover import CoverCfg
        from coral.reef.products.cover_calibration import SUFFIX, write_calibration
        from coral.reef.recordings.perception import PicturePerception
        from coral.reef.recordings.run_recording import read_run
        from coral.reef.world.world import load_world

        if self.out is None or not self.out.name.endswith(SUFFIX) or self.out.exists():
            raise InputError("--out", "", str(self.out), f"a new file that ends in {SUFFIX}")
        eyes = open_eyes(self.perception)
        if eyes is None:
            raise InputError("--perception", "", "exact", "rgb or FILE.onnx: exact perception has no errors")
        reefs = []
        for run in self.runs:
            recording = read_run(run, PicturePerception(eyes, self.perception))
            reefs.append(gather_evidence(recording, load_world(run / SurveyFiles.WORLD), CoverCfg()))
            _tell(f"{len(reefs)} of {len(self.runs)} runs")
        names = " ".join(one.name for one in reefs)
        made = calibrate(reefs, f"coral reef eyes calibrate --perception {self.perception}, runs of {names}")
        write_calibration(made, self.out)
        rows = [
            {"reef": one.name, "true_m2": round(one.whole.true_m2, 3), "error": round(error, 4)}
            for one, (error, _) in zip(reefs, leave_one_out(reefs), strict=True)
        ]
        return {"file": str(self.out), "common": made.common, "patch_m": made.patch_m, "rows": rows}

    def _score(self) -> Mapping[str, Any]:
        from coral.reef.eyes.backends import open_eyes
        from coral.reef.eyes.doubt import DoubtCfg, drop_doubtful
        from coral.reef.eyes.ground_plane import ray_lengths
        from coral.reef.eyes.perception import CameraAttitude, SeenPicture, perceive_frame
        from coral.reef.paint.score import BANDS_M, EyesScore
        from coral.reef.world.geometry import Label

        eyes = open_eyes(self.perception)
        if eyes is None:
            raise InputError("--perception", "", "exact", "rgb or FILE.onnx: exact perception has no errors")
        scores: dict[tuple[str, str], EyesScore] = {}
        spent = 0.0
        for kind, camera, frame in self._taken():
            begun = time.process_time()
            perceived = perceive_frame(frame, eyes, camera, CameraAttitude())
            spent += time.process_time() - begun
            # An obstacle at a doubtful depth is seen all the same; how wrong depth is has a row of its own.
            kept = drop_doubtful(perceived, DoubtCfg(obstacle_depth=math.inf))
            assert kept.doubt is not None
            seen = SeenPicture(kept.labels, kept.depth, kept.doubt)
            scores.setdefault(kind, EyesScore()).add(seen, frame, ray_lengths(camera))
        total = sum(score.pictures for score in scores.values())
        return {
            "perception": self.perception,
            "bands_m": list(BANDS_M),
            "cpu_ms_per_picture": round(1e3 * spent / max(total, 1), 1),
            "rows": [
                {
                    "water": water,
                    "light": light,
                    "pictures": score.pictures,
                    "oyster_iou": score.overlap(Label.OYSTER),
                    "oyster_iou_within_3_m": score.overlap(Label.OYSTER, 3.0)[0],
                    "obstacle_recall": score.recall(Label.OBSTACLE),
                    "obstacle_iou": score.overlap(Label.OBSTACLE),
                    "depth_error": score.depth_error(),
                }
                for (water, light), score in scores.items()
            ],
        }

    def _taken(self) -> Iterator[tuple[tuple[str, str], CameraCfg, Frame]]:
        """Yield the names of water and light, the camera, and the picture with its truth."""
        from coral.reef.paint.painter import Painter
        from coral.reef.paint.viewpoints import choose_viewpoints
        from coral.reef.simulation.daylight import find_light
        from coral.reef.vehicle.camera import Camera, CameraCfg
        from coral.reef.world.generated import expand_names, find_world
        from coral.reef.world.scene import Scene
        from coral.reef.world.water_types import find_water

        camera = CameraCfg()
        for name in expand_names(self.worlds):
            world = find_world(name)
            scene = Scene.from_world(world)
            caster, rng = Camera(scene, camera), np.random.default_rng([self.seed, world.seed])
            poses = choose_viewpoints(scene, self.pictures, rng)
            for water, light in itertools.product(self.waters, self.lights):
                cfg = find_light(light, "--lights")
                painter = Painter(scene, camera, find_water(water, "--waters"), cfg, seed=world.seed)
                for k, pose in enumerate(poses):
                    frame = caster.render(pose)
                    yield (painter.water.name, light), camera, replace(frame, rgb=painter.paint(frame, pose, t=7.0 * k))

    def describe(self, result: Mapping[str, Any]) -> str:
        """Return the file, or a table in Markdown."""
        if self.action == "train":
            rows = [
                f"| {row['video']} | {row['iou']:.2f} | {row['precision']:.2f} | {row['recall']:.2f} "
                f"| {100 * row['said']:.0f} % | {100 * row['true']:.0f} % |"
                for row in result["rows"]
            ]
            table = (
                [
                    "| left out | IoU | precision | recall | oysters, said | outlined |",
                    "|---|---|---|---|---|---|",
                    *rows,
                ]
                if rows
                else []
            )
            made = f"{result['file']}, from {result['pictures']} painted and {result['real']} real pictures"
            return "\n".join([*table, made])
        if self.action == "calibrate":
            rows = [f"| {row['reef']} | {row['true_m2']:.2f} | {100 * row['error']:+.1f} % |" for row in result["rows"]]
            return "\n".join(["| reef | truth (m²) | error, calibrated on the others |", "|---|---|---|", *rows,
                              f"a reef's own error {100 * result['common']:.1f} %, and for 1 m² another "
                              f"{100 * result['patch_m']:.1f} %: {result['file']}"])  # fmt: skip
        bands = [f"{a:g}-{b:g} m" for a, b in zip(result["bands_m"][:-1], result["bands_m"][1:], strict=True)]
        lines = [
            f"| water | light | pictures | what | {' | '.join(bands)} |",
            f"|---|---|---|---|{'---|' * len(bands)}",
        ]
        for row in result["rows"]:
            for key, what in (
                ("oyster_iou", "oysters, IoU"),
                ("obstacle_recall", "obstacles, recall"),
                ("depth_error", "depth, median error"),
            ):
                values = " | ".join("" if value is None else f"{value:.2f}" for value in row[key])
                lines.append(f"| {row['water']} | {row['light']} | {row['pictures']} | {what} | {values} |")
        within = ", ".join(f"{row['water']} {row['light']} {row['oyster_iou_within_3_m']}" for row in result["rows"])
        return "\n".join(
            [*lines, f"oysters within 3 m, IoU: {within}", f"{result['cpu_ms_per_picture']} ms of CPU a picture"]
        )


def _tell(line: str) -> None:
    print(line, file=sys.stderr, flush=True)

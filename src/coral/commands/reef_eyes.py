"""`coral reef eyes`: train a network for the reef, or measure how well one sees."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np

from coral.config import Count, Positive
from coral.errors import InputError
from coral.flags import Argument
from coral.terminal import tell

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coral.reef.paint.labelled_pictures import LabelledPicture
    from coral.reef.vehicle.camera import CameraCfg
    from coral.reef.world.geometry import Frame


@dataclass(frozen=True, kw_only=True)
class ReefEyes:
    """Train our network on pictures of generated reefs, or score eyes on pictures whose truth is known."""

    action: Annotated[Literal["train", "score"], Argument()]
    """train: write --out FILE.onnx; needs the extra `train`. score: overlap of classes and error of depth by range, in
    painted pictures, or overlap of oysters by video in real ones (--labelled)."""
    perception: str | None = None
    """score: painted (the default) or FILE.onnx; of real pictures rgb (the default) or any other network."""
    worlds: tuple[str, ...] = ("all",)
    """score: reefs to take pictures of; `all` are the ten shipped ones, on which nothing is trained."""
    waters: tuple[str, ...] = ("clear", "1C", "bay")
    """score: waters of these pictures."""
    pictures: Count = 6
    """Pictures of each reef (and water)."""
    labelled: tuple[Path, ...] = ()
    """Folders of real pictures with oysters marked: YOLO or Roboflow, COCO, masks, CoralNet's points."""
    oysters: tuple[str, ...] = ()
    """Names (or numbers) of the classes there that are oysters; all of them, by default."""
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
        if self.seed < 0:
            raise InputError("--seed", "", self.seed, "a number of 0 or more")
        if self.action == "train":
            return self._train()
        return self._score_labelled() if self.labelled else self._score()

    def _train(self) -> Mapping[str, Any]:
        if self.out is None or self.out.suffix != ".onnx" or self.out.exists():
            raise InputError("--out", "", str(self.out), "a new file that ends in .onnx")
        try:
            from coral.reef.paint.training import TrainingCfg, export, train, weights_in
        except ImportError as error:
            raise InputError("coral reef eyes train", "", f"no package {error.name}", "the extra `train`") from None
        from coral.reef.eyes.reef_net import WEIGHTS
        from coral.reef.paint.familiar import (
            OYSTER_FROM,
            correct_odds,
            know_more,
            know_training,
            measure_left_out,
        )
        from coral.reef.paint.labelled_pictures import read_labelled
        from coral.reef.paint.teaching import gather_real, teach

        begin = None if self.begin is None else weights_in(WEIGHTS if str(self.begin) == "rgb" else self.begin)
        marked = [one for folder in self.labelled for one in read_labelled(folder, self.oysters)]
        unknown = set(self.without) - {one.video for one in marked}
        if unknown:
            raise InputError("--without", "", sorted(unknown)[0], ", ".join(sorted({one.video for one in marked})))
        kept = [one for one in marked if one.video not in self.without]
        data = teach(
            self.seed, reefs=self.reefs, pictures=self.pictures, real=gather_real(kept), processes=self.threads,
            tell=tell,
        )  # fmt: skip
        cfg = TrainingCfg(
            rate=6e-4 if begin else 3e-3,
            steps=self.steps,
            batch=self.batch,
            limit_s=self.limit_s,
            threads=self.threads,
            device=self.device,
        )
        net = train(data, cfg, self.seed, tell, begin)
        if begin is None:
            know_training(net, kept, data.reefs, self.seed)
        else:
            know_more(net, kept, self.seed)
        correct_odds(net)
        self.out.parent.mkdir(parents=True, exist_ok=True)
        export(net, self.out, OYSTER_FROM)
        rows = measure_left_out(net, [one for one in marked if one.video in self.without])
        return {"file": str(self.out), "pictures": 2 * self.reefs * self.pictures, "real": len(kept), "rows": rows}

    def _score(self) -> Mapping[str, Any]:
        from coral.reef.eyes.backends import open_eyes
        from coral.reef.eyes.doubt import DoubtCfg, drop_doubtful
        from coral.reef.eyes.perception import CameraAttitude, SeenPicture, perceive_frame
        from coral.reef.map.eyesight import Eyesight, looks_of
        from coral.reef.paint.score import BANDS_M, EyesScore
        from coral.reef.vehicle.camera import ray_lengths
        from coral.reef.world.geometry import Label

        name = self.perception or "painted"
        eyes = open_eyes(name, painted=True)
        if eyes is None:
            raise InputError("--perception", "", "exact", "painted or FILE.onnx: exact perception has no errors")
        scores: dict[str, EyesScore] = {}
        eyesights: dict[str, Eyesight] = {}
        spent = 0.0
        for water, camera, frame in self._taken():
            begun = time.process_time()
            perceived = perceive_frame(frame, eyes, camera, CameraAttitude())
            spent += time.process_time() - begun
            eyesights.setdefault(water, Eyesight(camera)).look(perceived, looks_of(camera))
            kept = drop_doubtful(perceived, DoubtCfg())
            assert kept.doubt is not None
            seen = SeenPicture(kept.labels, kept.depth, kept.doubt)
            scores.setdefault(water, EyesScore()).add(seen, frame, ray_lengths(camera))
        total = sum(score.pictures for score in scores.values())
        return {
            "perception": name,
            "bands_m": list(BANDS_M),
            "cpu_ms_per_picture": round(1e3 * spent / max(total, 1), 1),
            "rows": [
                {
                    "water": water,
                    "pictures": score.pictures,
                    "oyster_iou": score.overlap(Label.OYSTER),
                    "oyster_iou_within_3_m": score.overlap(Label.OYSTER, 3.0)[0],
                    "oyster_recall": score.recall(Label.OYSTER),
                    "floor_doubt": score.floor_doubt(),
                    "sees_m": round(eyesights[water].reach_m, 2),
                    "obstacle_recall": score.recall(Label.OBSTACLE),
                    "obstacle_iou": score.overlap(Label.OBSTACLE),
                    "depth_error": score.depth_error(),
                }
                for water, score in scores.items()
            ],
        }

    def _score_labelled(self) -> Mapping[str, Any]:
        from coral.reef.eyes.backends import open_eyes
        from coral.reef.eyes.perception import CameraAttitude
        from coral.reef.paint.labelled_pictures import read_labelled
        from coral.reef.paint.score import video_rows
        from coral.reef.vehicle.camera import CameraCfg
        from coral.reef.world.geometry import Label

        name = self.perception or "rgb"
        eyes = open_eyes(name)
        if eyes is None:
            raise InputError("--perception", "", "exact", "rgb, painted or FILE.onnx: a network that sees pictures")
        pictures, judged = Counter[str](), Counter[str]()

        def seen() -> Iterator[tuple[LabelledPicture, NDArray[np.bool_], NDArray[Any]]]:
            for one in (picture for folder in self.labelled for picture in read_labelled(folder, self.oysters)):
                camera = CameraCfg(width=one.rgb.shape[1], height=one.rgb.shape[0])
                found = eyes.perceive(one.rgb, camera, CameraAttitude())
                pictures[one.video] += 1
                judged[one.video] += found.unlike < 1.0
                said = found.labels == Label.OYSTER
                yield one, said, said

        rows = [
            {**row, "pictures": pictures[row["video"]], "judged": judged[row["video"]]} for row in video_rows(seen())
        ]
        return {"perception": name, "rows": rows}

    def _taken(self) -> Iterator[tuple[str, CameraCfg, Frame]]:
        """Yield the name of the water, the camera, and the picture with its truth."""
        from coral.reef.paint.painter import Painter
        from coral.reef.paint.viewpoints import choose_viewpoints
        from coral.reef.vehicle.camera import Camera, CameraCfg
        from coral.reef.world.find_world import expand_names, find_world
        from coral.reef.world.scene import Scene
        from coral.reef.world.water_types import find_water

        camera = CameraCfg()
        for name in expand_names(self.worlds):
            world = find_world(name)
            scene = Scene.from_world(world)
            caster, rng = Camera(scene, camera), np.random.default_rng([self.seed, world.seed])
            poses = choose_viewpoints(scene, self.pictures, rng)
            for water in self.waters:
                painter = Painter(scene, camera, find_water(water, "--waters"), seed=world.seed)
                for k, pose in enumerate(poses):
                    frame = caster.render(pose)
                    yield painter.water.name, camera, replace(frame, rgb=painter.paint(frame, pose, t=7.0 * k))

    def describe(self, result: Mapping[str, Any]) -> str:
        if "bands_m" not in result:
            rows = [
                f"| {row['video']} | {row['iou']:.2f} | {row['precision']:.2f} | {row['recall']:.2f} "
                f"| {100 * row['said']:.0f} % | {100 * row['true']:.0f} % |"
                + (f" {row['judged']} of {row['pictures']} |" if "judged" in row else "")
                for row in result["rows"]
            ]
            if self.action == "score":
                head = ["| video | IoU | precision | recall | oysters, said | outlined | pictures judged |"]
                return "\n".join([*head, "|---|---|---|---|---|---|---|", *rows])
            head = ["| left out | IoU | precision | recall | oysters, said | outlined |", "|---|---|---|---|---|---|"]
            made = f"{result['file']}, from {result['pictures']} painted and {result['real']} real pictures"
            return "\n".join([*(head if rows else ()), *rows, made])
        bands = [f"{a:g}-{b:g} m" for a, b in zip(result["bands_m"][:-1], result["bands_m"][1:], strict=True)]
        lines = [f"| water | pictures | what | {' | '.join(bands)} |", f"|---|---|---|{'---|' * len(bands)}"]
        for row in result["rows"]:
            for key, what in (
                ("oyster_iou", "oysters, IoU"),
                ("oyster_recall", "oysters, recall"),
                ("floor_doubt", "sea floor, median doubt"),
                ("obstacle_recall", "obstacles, recall"),
                ("depth_error", "depth, median error"),
            ):
                digits = 3 if key == "floor_doubt" else 2
                values = " | ".join("" if value is None else f"{value:.{digits}f}" for value in row[key])
                lines.append(f"| {row['water']} | {row['pictures']} | {what} | {values} |")
        within = ", ".join(f"{row['water']} {row['oyster_iou_within_3_m']}" for row in result["rows"])
        far = ", ".join(f"{row['water']} {row['sees_m']} m" for row in result["rows"])
        lines += [f"oysters within 3 m, IoU: {within}", f"oysters are told from sea floor up to: {far}"]
        return "\n".join([*lines, f"{result['cpu_ms_per_picture']} ms of CPU a picture"])

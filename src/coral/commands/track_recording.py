"""`coral contact track FOLDER`: accuracy of the tracker on recorded scenes."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from coral.errors import InputError

if TYPE_CHECKING:
    from coral.contact.real_scenes.tracking_accuracy import AccuracyCfg, MakeTracker
    from coral.contact.scene.trial import Trial


def track_recording(
    folder: Path,
    models: Path | None,
    make: MakeTracker,
    *,
    every: int,
    results: Path | None,
    masks: str | None = None,
) -> list[dict[str, Any]]:
    """Track the objects of a recorded scene; return a row for each.

    Args:
        folder: The scene, in the format of BOP.
        models: The folder of the models.
        make: Makes a tracker of an object.
        every: Use every n-th picture only.
        results: File for the estimated poses.
        masks: What segments the pictures, as `--masks` takes it; None for the recorded true masks.
    """
    from coral.contact.real_scenes.bop_records import BopFiles
    from coral.contact.real_scenes.bop_scene import BopScene
    from coral.contact.real_scenes.bop_writing import write_bop_results
    from coral.contact.real_scenes.masks.colour_masks import FILE, read_colours
    from coral.contact.real_scenes.masks.mask_registry import MaskSetting, make_masks
    from coral.contact.real_scenes.recorded_accuracy import SceneTracking, summarize_poses

    if results is not None and results.exists():
        raise InputError("--results", "", str(results), "a new file")
    scene = BopScene(folder, models)
    if not scene.has_depth:
        raise InputError(str(folder / BopFiles.DEPTH), "", "no such folder", "pictures of depth")
    read, source = scene.read_frame, None
    if masks is not None:
        tracked = {str(number): scene.model(number) for number in scene.objects}
        colours = folder / FILE
        source = make_masks(masks, MaskSetting(tracked, lambda: read_colours(colours)))
        read = scene.read_bare_frame
    tracking = SceneTracking(scene, make, source)
    poses = [one for picture in scene.pictures[::every] for one in tracking.poses(picture, read(picture))]
    tracking.close()
    if results is not None:
        write_bop_results(results, scene, poses)
    kind = "true" if masks is None else masks.partition(":")[0]
    about = {"scene": str(folder), "masks": kind}
    return [about | dataclasses.asdict(row) for row in summarize_poses(poses)]


def describe_recordings(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the lines of a table."""
    lines = [
        f"{'scene':<16} {'object':>6} {'masks':<6} {'how':<8} {'poses':>5} {'seen':>5} {'mm':>6} "
        f"{'95 %':>7} {'deg':>6} {'95 %':>6} {'ADD':>5} {'MSSD':>5} {'lost':>5} {'false':>5} {'s':>6}"
    ]
    for r in rows:
        how = "followed" if r["followed"] else "fresh"
        errors = " ".join(
            _number(r[name], width) for name, width in (("mm", 6), ("mm_95", 7), ("deg", 6), ("deg_95", 6))
        )
        lines.append(
            f"{Path(r['scene']).name:<16} {r['object']:>6} {r['masks']:<6} {how:<8} {r['poses']:>5} "
            f"{r['visible']:>5.0%} {errors} {r['add_recall']:>5.0%} {r['mssd_recall']:>5.0%} {r['lost']:>5} "
            f"{r['false']:>5} {r['seconds']:>6.3f}"
        )
    lines += [
        "",
        "ADD: poses with an ADD (ADD-S if symmetric) below a tenth of the diameter; MSSD: recall averaged over 0.05 to",
        "0.5 diameters; lost: reported as lost; false: wrong by ADD and not reported; errors: of poses not lost",
    ]
    return lines


def export_motion(trial: Trial, cfg: AccuracyCfg, folder: Path) -> int:
    """Write a task's motion as a recorded scene; return the number of its pictures.

    Raises:
        InputError: The folder is not empty.
    """
    from coral.contact.perception.object_model import from_trial
    from coral.contact.real_scenes.bop_writing import BopWriter
    from coral.contact.real_scenes.masks.colour_masks import FILE, paint_regions, write_colours
    from coral.contact.real_scenes.tracking_accuracy import take_motion

    model, frames, truths = take_motion(trial, dataclasses.replace(cfg, colours="shaded"))
    writer = BopWriter(folder, {name: from_trial(model, trial, name) for name in trial.objects})
    for frame, truth in zip(frames, truths, strict=True):
        writer.add(frame, truth)
    writer.close()
    with contextlib.suppress(InputError):  # objects of one colour have no regions
        regions = paint_regions({name: trial.task.object(name).color for name in trial.objects})
        write_colours(folder / FILE, {str(1 + k): region for k, region in enumerate(regions.values())})
    return len(frames)


def _number(value: float | None, width: int) -> str:
    return f"{'-':>{width}}" if value is None else f"{value:>{width}.1f}"

"""`coral contact track`: accuracy and speed of the tracker on the tasks' motions."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from coral.contact.perception.depth_noise import Sensor
from coral.contact.perception.tracker_registry import choose_tracker, tracker_help
from coral.errors import InputError
from coral.flags import Argument, Option

if TYPE_CHECKING:
    from coral.contact.perception.object_model import ObjectModel
    from coral.contact.perception.tracker import PoseTracker


@dataclass(frozen=True, kw_only=True)
class ContactTrack:
    """Track the objects of tasks through synthetic motions seen by a depth camera, and print the errors.

    The objects move as in the task, with a two-finger hand in the way; then they are taken out of view, and covered by
    the hand, for a second each.
    """

    tasks: Annotated[tuple[str, ...], Argument(metavar="[TASK ...]")] = ()
    """Names or task files, all shipped tasks by default."""
    tracker: Annotated[str, Option(help=f"The tracker: {tracker_help()}.")] = "model"
    seed: int = 0
    """Seed of the trials and of the noise."""
    width: int = 320
    """Columns of the camera; the aspect ratio is 4:3."""
    rate_hz: float = 10.0
    """Pictures per second."""
    noise: bool = True
    """Whether depth and outlines have a real camera's noise."""
    sensor: Sensor = "kinect"
    """Which camera's noise: of short-range structured light, or of a stereo camera such as the D435."""
    losses: bool = True
    """Also measure loss and recovery."""
    export: Path | None = None
    """Write the pictures of one task's motion into this folder, for --camera recording:FOLDER, and measure nothing."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        """Run the measurements."""
        from coral.contact.perception.camera import RgbdCameraCfg
        from coral.contact.perception.depth_noise import SENSORS, DepthNoise
        from coral.contact.real_scenes.bop_writing import record_motion
        from coral.contact.real_scenes.tracking_accuracy import AccuracyCfg, measure_accuracy
        from coral.contact.real_scenes.tracking_loss import measure_loss
        from coral.contact.scene.task_file import shipped_tasks
        from coral.contact.scene.trial import sample_trial
        from coral.contact.tasks import load_task

        choice = choose_tracker(self.tracker)
        if not 64 <= self.width <= 4096:
            raise InputError("--width", "", self.width, "64 to 4096 columns")
        if not 1.0 <= self.rate_hz <= 100.0:
            raise InputError("--rate-hz", "", self.rate_hz, "1 to 100 pictures per second")
        if self.seed < 0:
            raise InputError("--seed", "", self.seed, "0 or more")
        cfg = AccuracyCfg(
            camera=RgbdCameraCfg(width=self.width, height=round(self.width * 0.75)),
            period_s=1.0 / self.rate_hz,
            noise=DepthNoise(SENSORS[self.sensor]) if self.noise else None,
            colours="shaded" if choice.wants_colours else "none",
        )
        if self.export is not None:
            if len(self.tasks) != 1:
                raise InputError("--export", "", f"{len(self.tasks)} tasks", "one task")
            count = record_motion(sample_trial(load_task(self.tasks[0]), self.seed), cfg, self.export)
            return {"exported": str(self.export), "pictures": count}
        choice.check()

        def make(model: ObjectModel) -> PoseTracker:
            return choice.make(model, None)

        trials = [sample_trial(load_task(name), self.seed) for name in self.tasks or shipped_tasks()]
        tracked = [dataclasses.asdict(row) for trial in trials for row in measure_accuracy(trial, make, cfg)]
        lost = [
            dataclasses.asdict(measure_loss(trial, make, cfg, how))
            for trial in trials
            if self.losses
            for how in ("out of view", "covered")
        ]
        return {
            "tracker": self.tracker,
            "seed": self.seed,
            "width": self.width,
            "noise": self.noise,
            "tracked": tracked,
            "lost": lost,
        }

    def describe(self, result: Mapping[str, Any]) -> str:
        """Return the tables."""
        if "exported" in result:
            return f"{result['pictures']} pictures: {result['exported']}"
        lines = [
            "Errors modulo symmetry over all pictures: median and what 95 % stay below.",
            "",
            f"{'task':<16} {'object':<10} {'seen':>5} {'mm':>5} {'95 %':>6} {'deg':>5} {'95 %':>6} "
            f"{'lost':>5} {'ms':>6} {'95 %':>6} {'fresh':>6} {'s':>5}",
        ]
        for r in result["tracked"]:
            lines.append(
                f"{r['task']:<16} {r['object']:<10} {r['least_visible']:>5.0%} {r['mm']:>5.1f} {r['mm_95']:>6.1f} "
                f"{r['deg']:>5.1f} {r['deg_95']:>6.1f} {r['lost']:>5} {r['update_ms']:>6.1f} {r['update_ms_95']:>6.1f} "
                f"{r['registered']:>3}/{r['registrations']} {r['registration_s']:>5.2f}"
            )
        lines += [
            "",
            "seen: least share of the object; fresh: fresh starts within 5 mm and 5 deg, and their time",
        ]
        if result["lost"]:
            lines += [
                "",
                f"{'task':<16} {'object':<10} {'how':<12} {'noticed':>8} {'reported':>9} {'recovered':>10} "
                f"{'mm':>5} {'deg':>5} {'slowest s':>10}  reason",
            ]
            for r in result["lost"]:
                noticed = f"{r['noticed_frames']}" if r["noticed_frames"] else "never"
                recovered = f"{r['recovered_frames']}" if r["recovered_frames"] else "never"
                lines.append(
                    f"{r['task']:<16} {r['object']:<10} {r['how']:<12} {noticed:>8} {r['reported']:>9.0%} "
                    f"{recovered:>10} {r['mm']:>5.1f} {r['deg']:>5.1f} {r['slowest_s']:>10.2f}  {r['reason']}"
                )
            lines += ["", "noticed, recovered: number of pictures until then; reported: share of the second without it"]
        return "\n".join(lines)

"""`coral contact identify`: identify mass and friction of a board by contact, from a wrong belief (Fig. 4)."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from coral.commands.progress import EpisodeProgress
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.identification_episode import probe_episode
from coral.contact.episode.resolution import with_poses, with_samples
from coral.contact.scene.trial import PhysicalParameters, Trial, sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.registry import check_world
from coral.errors import InputError


@dataclass(frozen=True, kw_only=True)
class ContactIdentify:
    """Touch a board of known mass and friction, and measure how fast and how well replaying the history finds them."""

    task: str = "push-pick-board"
    """Task whose first object is touched."""
    world: str = "panda"
    """Evaluation world: hand or panda."""
    mass: float = 0.1
    """True mass, kg."""
    friction: float = 0.5
    """True friction."""
    believed_mass: float = 2.0
    """Initial belief of the mass, kg."""
    believed_friction: float = 0.9
    """Initial belief of the friction."""
    seed: int = 0
    """Seed of the trial and of the fits."""
    every: float = 2.0
    """Interval of corrections in simulated time (s), five at most, the last at its end."""
    poses: Literal["tracked", "ground-truth"] | None = None
    """Source of the object's poses; tracked by default."""
    samples: int | None = None
    """Rollouts per plan, instead of the configuration's."""
    out: Path | None = None
    """Keep the run folder here."""
    figure: Path | None = None
    """Also draw the corrections into this PNG."""
    json: bool = False
    """Print one JSON object on standard output."""
    quiet: bool = False
    """No progress bar."""

    def __call__(self) -> Mapping[str, Any]:
        """Touch and correct."""
        check_world(self.world)
        for flag, value in (
            ("--mass", self.mass),
            ("--friction", self.friction),
            ("--believed-mass", self.believed_mass),
            ("--believed-friction", self.believed_friction),
        ):
            if not 0.01 <= value <= 20:
                raise InputError(flag, "", value, "a number from 0.01 to 20")
        if self.seed < 0:
            raise InputError("--seed", "", self.seed, "a number of 0 or more")
        if not 0.2 <= self.every <= 60:
            raise InputError("--every", "", self.every, "a number of seconds from 0.2 to 60")
        trial = sample_trial(load_task(self.task), self.seed)
        name = trial.task.objects[0].name
        found = self._episode(trial, name)
        believed = [PhysicalParameters(*row["believed"]) for row in found["corrections"]]
        last = believed[-1] if believed else self._first
        if self.figure is not None:
            self._draw(believed, self.figure)
        return {
            "object": name,
            "mass_kg": self.mass,
            "friction": self.friction,
            **found,
            "mass_error": round(last.mass_kg / self.mass - 1, 4),
            "friction_error": round(last.friction / self.friction - 1, 4),
            "figure": None if self.figure is None else str(self.figure),
        }

    def describe(self, result: Mapping[str, Any]) -> str:
        """Describe every correction and the remaining error."""
        lines = [
            f"{index}. {'accepted' if row['accepted'] else 'refused '}  at {row['t']:.1f} s, {row['text']}"
            for index, row in enumerate(result["corrections"], start=1)
        ]
        lines.append(f"the episode: {result['end_reason']} after {result['sim_time_s']:.1f} s")
        return "\n".join(
            [
                *lines,
                f"remaining error: mass {100 * result['mass_error']:+.0f} %, friction "
                f"{100 * result['friction_error']:+.0f} % of {self.mass:g} kg and {self.friction:g}",
            ]
        )

    @property
    def _first(self) -> PhysicalParameters:
        return PhysicalParameters(self.believed_mass, self.believed_friction)

    def _episode(self, trial: Trial, name: str) -> dict[str, Any]:
        cfg = EpisodeCfg()
        identify = replace(cfg.think.identify, by="balance")
        cfg = replace(
            cfg,
            think=replace(cfg.think, correct_every_s=self.every, identify=identify),
            record=replace(cfg.record, report=False),
        )
        cfg = with_poses(with_samples(cfg, self.samples), self.poses)
        progress = EpisodeProgress(quiet=self.quiet)
        with tempfile.TemporaryDirectory() as aside:
            try:
                found = probe_episode(
                    trial,
                    name,
                    PhysicalParameters(self.mass, self.friction),
                    self._first,
                    cfg,
                    self.out or Path(aside) / "run",
                    self.world,
                    progress,
                )
            finally:
                progress.close()
        return {
            "corrections": [
                {
                    "t": event["t"],
                    "accepted": event["accepted"],
                    "believed": event["after"],
                    "error_before": event["errors"][0],
                    "error_after": event["errors"][1],
                    "text": event["text"],
                }
                for event in found.corrections
            ],
            "end_reason": found.end_reason,
            "sim_time_s": found.sim_time_s,
        }

    def _draw(self, believed: list[PhysicalParameters], path: Path) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=(7, 2.8), layout="constrained")
        FigureCanvasAgg(figure)
        for axes, key, first, true, unit in zip(
            figure.subplots(1, 2),
            ("mass_kg", "friction"),
            (self.believed_mass, self.believed_friction),
            (self.mass, self.friction),
            ("mass (kg)", "friction"),
            strict=True,
        ):
            values = [first, *(getattr(one, key) for one in believed)]
            axes.fill_between([0, len(values) - 1], 0.85 * true, 1.15 * true, color="0.9", label="15 %")
            axes.axhline(true, color="0.4", linewidth=1, label="true")
            axes.plot(range(len(values)), values, "o-", color="tab:blue", label="believed")
            axes.set(xlabel="corrections", ylabel=unit, yscale="log" if key == "mass_kg" else "linear")
        figure.axes[0].legend(frameon=False)
        try:
            figure.savefig(path, format="png", dpi=150, metadata={"Software": None})
        except OSError as error:
            raise InputError("--figure", "", str(path), f"a file that can be written ({error.strerror})") from None

"""`coral contact identify`: find the mass and friction of a pushed board from a belief that is far off (Fig. 4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from coral.contact.draw import Physical, draw
from coral.contact.task import load_task
from coral.contact.thinking.identify import Fit
from coral.contact.thinking.probe import ProbeCfg, probe
from coral.contact.worlds import check_world
from coral.errors import InputError


@dataclass(frozen=True, kw_only=True)
class ContactIdentify:
    """Push a board of known mass and friction, and see how fast and how well replaying the history finds them."""

    task: str = "push-pick-board"
    """Task whose first object is pushed."""
    world: str = "hand"
    """Where it is pushed: hand or panda."""
    mass: float = 0.1
    """True mass, kg."""
    friction: float = 0.5
    """True friction."""
    believed_mass: float = 2.0
    """Mass believed at first, kg."""
    believed_friction: float = 0.9
    """Friction believed at first."""
    seed: int = 0
    """Seed of the trial and of the fits."""
    figure: Path | None = None
    """Also draw the corrections into this PNG."""
    json: bool = False
    """Print one JSON object on standard output."""
    cfg: ProbeCfg = field(default_factory=ProbeCfg)
    """The experiment."""

    def __call__(self) -> Mapping[str, Any]:
        """Push and correct."""
        check_world(self.world)
        for flag, value in (("--mass", self.mass), ("--friction", self.friction),
                            ("--believed-mass", self.believed_mass), ("--believed-friction", self.believed_friction)):
            if not 0.01 <= value <= 20:
                raise InputError(flag, "", value, "a number from 0.01 to 20")
        drawn = draw(load_task(self.task), self.seed)
        name = drawn.task.objects[0].name
        fits = list(probe(drawn, name, Physical(self.mass, self.friction),
                          Physical(self.believed_mass, self.believed_friction), self.cfg,
                          np.random.default_rng([self.seed, 4]), self.world))
        rows = [_row(fit) for fit in fits]
        believed = [fit.after if fit.accepted else fit.before for fit in fits]
        if self.figure is not None:
            self._draw(believed, self.figure)
        return {"object": name, "mass_kg": self.mass, "friction": self.friction, "corrections": rows,
                "mass_error": round(believed[-1].mass_kg / self.mass - 1, 4),
                "friction_error": round(believed[-1].friction / self.friction - 1, 4),
                "figure": None if self.figure is None else str(self.figure)}

    def describe(self, result: Mapping[str, Any]) -> str:
        """Every correction, and what is left of the error."""
        lines = [f"{index}. {'accepted' if row['accepted'] else 'refused '}  {row['text']}"
                 for index, row in enumerate(result["corrections"], start=1)]
        return "\n".join([*lines, f"left over: mass {100 * result['mass_error']:+.0f} %, friction "
                          f"{100 * result['friction_error']:+.0f} % of {self.mass:g} kg and {self.friction:g}"])

    def _draw(self, believed: list[Physical], path: Path) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=(7, 2.8), layout="constrained")
        FigureCanvasAgg(figure)
        for axes, key, first, true, unit in zip(
                figure.subplots(1, 2), ("mass_kg", "friction"), (self.believed_mass, self.believed_friction),
                (self.mass, self.friction), ("mass (kg)", "friction"), strict=True):
            values = [first, *(getattr(one, key) for one in believed)]
            axes.fill_between([0, len(values) - 1], 0.85 * true, 1.15 * true, color="0.9", label="15 %")
            axes.axhline(true, color="0.4", linewidth=1, label="true")
            axes.plot(range(len(values)), values, "o-", color="tab:blue", label="believed")
            axes.set(xlabel="corrections", ylabel=unit, yscale="log" if key == "mass_kg" else "linear")
        figure.axes[0].legend(frameon=False)
        try:
            figure.savefig(path, dpi=150, metadata={"Software": None})
        except OSError as error:
            raise InputError("--figure", "", str(path), f"a file that can be written ({error.strerror})") from None


def _row(fit: Fit) -> dict[str, Any]:
    return {"accepted": fit.accepted, "mass_kg": round(fit.after.mass_kg, 5), "friction": round(fit.after.friction, 4),
            "mass_sd": round(fit.mass_sd, 3), "friction_sd": round(fit.friction_sd, 3),
            "product_sd": round(fit.product_sd, 3), "error_before": round(fit.error_before, 4),
            "error_after": round(fit.error_after, 4), "windows": fit.windows, "text": fit.words()}

"""The paper's Fig. 5 from run folders: the tool's paths and the planning cost, with and without a contact strategy."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from coral.file_writer import write_whole, writing
from coral.odd_text import printable
from coral.view.run import RunFolder

HUES = ("#178048", "#c8352b", "#c8862b")
"""Colours of the variants with and without the strategy, as in the paper; and of the one between."""


def draw_ablation(runs: Mapping[str, Sequence[Path]], path: Path, title: str) -> None:
    """Write the figure as PNG, atomically.

    Args:
        runs: Run folders by variant, the one with the strategy first; the same seeds in the same order.
        path: Path of the picture; replaced.
        title: Title of the picture.

    Raises:
        InputError: The picture cannot be written, or a folder is not a run.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    FigureCanvasAgg(figure)
    paths, costs = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
    for (name, folders), hue in zip(runs.items(), HUES, strict=False):
        read = [RunFolder.read(folder) for folder in folders]
        if not read:
            continue
        if hue == HUES[0]:
            _scene(paths, read[0])
        # Highlight the trial of median length and draw the others faintly.
        order = sorted(range(len(read)), key=lambda k: len(read[k].column("t")))
        shown = order[len(order) // 2]
        for k, run in enumerate(read):
            style = {
                "color": hue,
                "lw": 1.8 if k == shown else 0.7,
                "alpha": 1.0 if k == shown else 0.3,
                "zorder": 4 if k == shown else 3,
            }
            label = name if k == shown else None
            paths.plot(run.column("x"), run.column("z"), label=label, **style)
            plans = run.select("plan")
            costs.plot([plan["step"] for plan in plans], [_cost(plan) for plan in plans], label=label, **style)
    paths.set(xlabel="x (m), away from the robot", ylabel="z (m)", aspect="equal")
    paths.set_title("Path of the tool, from the side", fontsize=9)
    costs.set(xlabel="control steps", ylabel="expected cost of the plan", yscale="symlog")
    costs.set_title("Planning cost", fontsize=9)
    costs.legend(frameon=False, fontsize=8)
    for axes in (paths, costs):
        axes.grid(alpha=0.25, lw=0.5)
        axes.tick_params(labelsize=8)
    figure.suptitle(printable(title), fontsize=9, parse_math=False)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=140, metadata={"Software": None})
    with writing(path):
        write_whole(path, buffer.getvalue())


def _scene(axes: Any, run: RunFolder) -> None:
    """Draw the table, the fixtures and the objects' initial places, from the side."""
    from matplotlib.patches import Rectangle

    table = run.world.get("table") or {}
    center, size = table.get("center", (0.0, 0.0)), table.get("size", (0.8, 0.8))
    axes.add_patch(Rectangle((center[0] - size[0] / 2, -0.03), size[0], 0.03, color="0.82", zorder=1))
    for item in run.world.get("fixtures") or ():
        (x, _, z), (length, _, height) = item["position"], item["size"]
        axes.add_patch(Rectangle((x - length / 2, z - height / 2), length, height, color="0.62", zorder=2))
    start = next(iter(run.select("start")), {})
    for name, item in (start.get("trial") or {}).items():
        x, z = run.column(f"{name}_x"), run.column(f"{name}_z")
        length, _, height = item["size_m"]
        if len(x):
            axes.add_patch(
                Rectangle(
                    (x[0] - length / 2, z[0] - height / 2), length, height, fc="#e3b27a", ec="#a6702f", lw=0.8, zorder=2
                )
            )


def _cost(plan: Mapping[str, Any]) -> float:
    return float("nan") if plan.get("cost") is None else float(np.clip(plan["cost"], -1e6, 1e6))

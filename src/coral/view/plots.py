"""Plots of a run for a notebook: the map and what was seen by when, or how objects moved and with what force."""

from __future__ import annotations

import io
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coral.drawing import png_url
from coral.reef.pictures.mapview import draw_map
from coral.run_files import SurveyFiles
from coral.view.run import RunFolder, read_table
from coral.view.runmap import scene_at

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def plot_survey(folder: Path) -> Figure:
    """Draw the robot's final map, and the shares covered and inspected over time.

    Raises:
        InputError: The folder is no run.
    """
    run = RunFolder.read(folder)
    figure, (left, right) = _two_axes()
    left.imshow(draw_map(scene_at(run, run.duration_s)).rgb)
    left.set_axis_off()
    left.set_title("the robot's map" if run.frame_steps else "the robot's path (this run kept no map)")
    right.plot(run.column("t"), 100 * run.column("coverage"), label="covered")
    judged = read_table(run.path / SurveyFiles.JUDGE)
    if len(judged.get("inspected", ())):
        right.plot(judged["t"], 100 * judged["inspected"], label="inspected")
    _finish(right, "clusters and oysters (%)")
    right.set_ylim(-3, 103)
    return figure


def plot_attempt(folder: Path) -> Figure:
    """Draw how far each object has moved and turned away from its first pose, and the force on the hand.

    Raises:
        InputError: The folder is no run.
    """
    run = RunFolder.read(folder)
    figure, (left, right) = _two_axes()
    t = run.column("t")
    names = [name.removesuffix("_qw") for name in run.trajectory if name.endswith("_qw") and name != "cmd_qw"]
    for name in names:
        path = np.stack([run.column(f"{name}_{axis}") for axis in "xyz"], axis=1)
        left.plot(t, 100 * np.linalg.norm(path - path[0], axis=1), label=name)
    _finish(left, "moved from the first place (cm)")
    right.plot(t, np.linalg.norm([run.column(f"f{axis}") for axis in "xyz"], axis=0), label="on the hand")
    _finish(right, "force (N)")
    return figure


def html_of(title: str, values: Mapping[str, Any], figure: Figure) -> str:
    """Return a run as HTML: a title, a row of values, and the plot."""
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=90)
    cells = "".join(f"<td>{escape(name)}<br><b>{escape(str(value))}</b></td>" for name, value in values.items())
    image = f'<img alt="plot of the run" src="{png_url(picture.getvalue())}">'
    return f"<p>{escape(title)}</p><table><tr>{cells}</tr></table>{image}"


def _two_axes() -> tuple[Figure, tuple[Axes, Axes]]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4), layout="constrained")
    left, right = figure.subplots(1, 2)
    return figure, (left, right)


def _finish(axes: Axes, quantity: str) -> None:
    axes.set(xlabel="simulated time (s)", ylabel=quantity)
    axes.grid(alpha=0.3)
    axes.legend()

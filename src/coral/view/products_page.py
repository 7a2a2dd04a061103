"""The products of a survey as one self-contained page for people."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from coral.drawing import png, png_url
from coral.reef.products.cover import FINE_M, RANGE_M
from coral.reef.products.files import make_layers
from coral.reef.products.placement import EarthPlacement
from coral.reef.products.product_files import ProductFiles
from coral.reef.products.survey_products import DENSITY_CELL_M, SurveyProducts
from coral.reef.products.truth import TrueOysters, true_oysters
from coral.reef.recordings.recording import EXACT, RECORDED
from coral.reef.world.world_model import ReefWorld
from coral.view.page import render_page, write_page
from coral.words import clock

UNSEEN = (214, 218, 222)

Stop = tuple[float, str, str]
"""Value, colour as #rrggbb, label."""

COVER_STOPS: tuple[Stop, ...] = (
    (0.0, "#f4efe3", "0 %"),
    (0.1, "#cfe3bf", "10 %"),
    (0.3, "#7fbf8a", "30 %"),
    (0.6, "#2f8f68", "60 %"),
    (1.0, "#0b4a4f", "100 %"),
)
DISTANCE_STOPS: tuple[Stop, ...] = (
    (0.0, "#0b4a4f", "0 m"),
    (1.5, "#2f8f68", "1.5 m"),
    (3.0, "#b8d67c", "3 m"),
    (6.0, "#f0b429", "6 m"),
)


@dataclass(frozen=True)
class TruthComparison(TrueOysters):
    """What a simulated reef adds: the true area on the floor that was seen, and how far the survey is from it."""

    error: float | None
    """Estimate over truth, minus 1; None where no oyster was in sight, or nothing was judged."""
    inside: bool
    """Whether the truth lies in the interval."""
    oysters_error: float | None
    """Estimate over truth, minus 1; None where nothing was estimated."""

    @classmethod
    def of(cls, products: SurveyProducts, world: ReefWorld) -> TruthComparison:
        """Compare with a reef."""
        area, count = products.area, products.shells.oysters
        true = true_oysters(world, products.seen, FINE_M)
        return cls(
            **vars(true),
            error=area.value / true.m2 - 1.0 if true.m2 and products.judgement.judged else None,
            inside=area.low <= true.m2 <= area.high,
            oysters_error=count.value / true.oysters - 1.0 if count is not None and true.oysters else None,
        )


def write_products_page(
    products: SurveyProducts,
    placement: EarthPlacement,
    folder: Path,
    files: Sequence[str],
    truth: TruthComparison | None = None,
    lens: str = "",
) -> Path:
    """Write `products.html`, which loads nothing from elsewhere, and return its path.

    Raises:
        InputError: The page cannot be written.
    """
    datum, size = placement.datum, products.recording.size_m
    looks: dict[int, list[tuple[str, str]]] = {}
    for picture in products.pictures:
        caption = f"at {clock(picture.t)}, from ({picture.x:.1f}, {picture.y:.1f}) m"
        looks.setdefault(picture.cluster, []).append((_data(picture.image), caption))
    where = "Metres of the recording; no datum was given, so nothing is placed on Earth."
    if datum is not None:
        start = f"{datum.latitude:.6f}, {datum.longitude:.6f}"
        where = f"Start at {start} (WGS 84); rasters and layers in EPSG:{placement.epsg}."
    note = "Colours as the camera saw them through the water."
    if not products.mosaic.colour:
        note = "The recording has no colour pictures: these are classes (green: oysters, sand: floor, dark: obstacles)."
    page = render_page(
        "products.html.j2",
        name=products.recording.name,
        size=size,
        keyframes=products.keyframes,
        headline=_headline(products),
        lens=lens[:1].upper() + lens[1:],
        place=where,
        network=None if products.recording.seen_by in (RECORDED, EXACT) else products.recording.seen_by,
        calibrated=products.calibrated_reefs,
        area=products.area,
        shells=products.shells,
        not_judged=not products.judgement.judged,
        seen=products.seen_m2,
        clusters=[feature.values for feature in make_layers(products, placement)[0].features],
        truth=truth,
        mosaic=_data(products.mosaic.rgba[::-1]),
        mosaic_note=note,
        up="Up is the map's y axis.",
        overlay=Markup(_overlay(products)),
        density=_data(ramp(products.density, COVER_STOPS)[::-1], 12),
        nearest=_data(ramp(products.cells.nearest, DISTANCE_STOPS)[::-1], 2),
        density_cell=f"{DENSITY_CELL_M:g}",
        cover_ramp=Markup(_gradient(COVER_STOPS)),
        distance_ramp=Markup(_gradient(DISTANCE_STOPS)),
        range=f"{RANGE_M:g}",
        fine=FINE_M,
        datum=datum is not None,
        looks=sorted(looks.items()),
        files=files,
    )
    return write_page(folder, page, ProductFiles.PAGE)


def ramp(values: NDArray[np.float32], stops: Sequence[Stop]) -> NDArray[np.uint8]:
    """Return values as colours between the stops, gray where they are not finite. Shape=(H, W, 3), red first."""
    known = np.isfinite(values)
    colours = np.array([[int(colour[k : k + 2], 16) for k in (1, 3, 5)] for _, colour, _ in stops], np.float64)
    at = [value for value, _, _ in stops]
    channels = [np.interp(np.where(known, values, 0.0), at, colours[:, k]) for k in range(3)]
    return np.where(known[:, :, None], np.stack(channels, axis=2), UNSEEN).astype(np.uint8)


def _headline(products: SurveyProducts) -> str:
    area, count = products.area, len(products.clusters)
    groups = "one cluster" if count == 1 else f"{count} clusters"
    if warning := products.judgement.warning():
        return f"{warning}. Oysters may cover {area.low:.0f} to {area.high:.2f} m² of what they show."
    return (
        f"Oysters cover {area.value:.2f} m² of the sea floor ({area.low:.2f} to {area.high:.2f} m²), in {groups}; "
        f"{products.seen_m2:.0f} m² were seen near enough to tell."
    )


def _overlay(products: SurveyProducts) -> str:
    width, height = products.recording.size_m

    def points(line: NDArray[np.float64]) -> str:
        return " ".join(f"{x:.2f},{height - y:.2f}" for x, y in line)

    shapes = [f'<polyline class="way" points="{points(products.track)}"/>']
    for one in products.clusters:
        shapes += [f'<polygon class="outline" points="{points(ring)}"/>' for ring in one.outlines]
        shapes.append(f'<text x="{one.x:.2f}" y="{height - one.y + 0.2:.2f}">{one.number}</text>')
    return f'<svg viewBox="0 0 {width:g} {height:g}" preserveAspectRatio="none">{"".join(shapes)}</svg>'


def _gradient(stops: Sequence[Stop]) -> str:
    low, high = stops[0][0], stops[-1][0]
    return ",".join(f"{colour} {100 * (value - low) / (high - low):.0f}%" for value, colour, _ in stops)


def _data(image: NDArray[np.uint8], scale: int = 1) -> str:
    """Return a picture, Shape=(H, W, 3 or 4), red first, as a data address."""
    return png_url(png(np.repeat(np.repeat(image, scale, axis=0), scale, axis=1)))

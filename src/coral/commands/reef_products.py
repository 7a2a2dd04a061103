"""`coral reef products`: what a person takes home from a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from coral.config import checked
from coral.errors import InputError
from coral.flags import Argument, Option
from coral.reef.products.files import summary, write_products
from coral.reef.products.picture_labels import write_labels
from coral.reef.products.placement import EarthPlacement, parse_datum
from coral.reef.products.product_files import ProductFiles
from coral.reef.products.survey_products import ProductsCfg, measure
from coral.reef.recordings.recording import EXACT, RECORDED, Recording
from coral.reef.recordings.run_recording import read_run, true_reef
from coral.reef.world.world import ReefWorld
from coral.view.products_page import TruthComparison, write_products_page
from coral.words import many


@dataclass(frozen=True, kw_only=True)
class ReefProducts:
    """Make maps, tables and pictures for an ecologist from a run: orthomosaic, areas, densities, files for QGIS."""

    run: Annotated[Path, Argument(metavar="RUN")]
    """Run folder of a reef mission."""
    datum: Annotated[str | None, Option(metavar="LAT,LON[,HEADING]")] = None
    """Latitude and longitude of the start (WGS 84, degrees), and the compass heading there if the run's x axis does not
    point east."""
    out: Path | None = None
    """Folder of the products, new or empty; by default products/ in the run folder."""
    json: bool = False
    """Print one JSON object."""
    cfg: ProductsCfg = field(default_factory=ProductsCfg)
    """How they are made."""

    def __call__(self) -> Mapping[str, Any]:
        out = self.out or self.run / "products"
        if self.out is None and out.is_symlink():  # whoever made the run chose where it leads
            raise InputError(str(out), "", "a link to another folder", "no such file, or --out FOLDER")
        return make_products(read_run(self.run), self.cfg, self.datum, out, true_reef(self.run))

    def describe(self, result: Mapping[str, Any]) -> str:
        return describe_products(result)


def make_products(
    recording: Recording,
    cfg: ProductsCfg,
    datum: str | None,
    out: Path,
    true: ReefWorld | None = None,
    lens: str = "",
) -> dict[str, Any]:
    """Measure a recording, write all files into a new or empty folder, and return the main numbers.

    `datum` is LAT,LON[,HEADING], by default the recording's own. Only the comparison on the page sees the true reef;
    None where nobody knows it. `lens` says how the lens disagrees with the pictures, and leads if it does.

    Raises:
        InputError: Something of it cannot be used.
    """
    if datum is None and recording.datum is not None:
        datum = f"{recording.datum[0]!r},{recording.datum[1]!r}"
    where = None if datum is None else parse_datum(datum)
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError(str(out), "--out", "a folder that is not empty", "a new or empty folder")
    products = measure(recording, checked(cfg, "--cfg"))
    assert products.recording.start is not None
    placement = EarthPlacement(products.recording.start, where)
    files = write_products(products, placement, out, lens)
    labels = write_labels(products.recording, products.keyframes, cfg.labels, out / ProductFiles.LABELS)
    files = sorted([*files, *(f"{ProductFiles.LABELS}{name}" for name in labels)])
    truth = None if true is None else TruthComparison.of(products, true)
    page = write_products_page(products, placement, out, files, truth, lens)
    compared = {} if truth is None else _compared(truth)
    return {**summary(products, placement, lens), **compared, "products": str(out), "page": str(page), "files": files}


def _compared(truth: TruthComparison) -> dict[str, Any]:
    return {
        "true_area_m2": round(truth.m2, 3),
        "true_area_of_reef_m2": round(truth.whole_m2, 3),
        "area_error": truth.error and round(truth.error, 4),
        "truth_in_interval": truth.inside,
        "true_oysters": truth.oysters,
        "oysters_error": truth.oysters_error and round(truth.oysters_error, 4),
        "true_shell_length_mm": round(1000.0 * truth.length_m),
    }


def describe_products(result: Mapping[str, Any]) -> str:
    """Describe the products in a few lines."""
    why = str(result["not_judged"])
    lines = [result["lens"]] if result["lens"] else []
    lines += [
        f"{result['recording']}: {why[:1].lower()}{why[1:]}; oysters may cover "
        f"{result['oyster_area_low_m2']:.0f} to {result['oyster_area_high_m2']:.2f} m² of what they show, "
        f"{many(result['keyframes'], 'picture')}"
        if why
        else f"{result['recording']}: oysters cover {result['oyster_area_m2']:.2f} m² "
        f"({result['oyster_area_low_m2']:.2f} to {result['oyster_area_high_m2']:.2f} m²) in "
        f"{many(result['clusters'], 'cluster')}; {result['seen_m2']:.0f} m² of sea floor seen near enough, "
        f"{many(result['keyframes'], 'picture')}"
    ]
    if result["oysters"] is None:
        lines.append("how many oysters: too few lie apart to tell the size of one")
    else:
        apart = f"{result['outlines']:.0f} ({result['outlines_low']:.0f} to {result['outlines_high']:.0f})"
        lines.append(
            f"about {result['oysters']:.0f} oysters ({result['oysters_low']:.0f} to {result['oysters_high']:.0f}), "
            f"{result['oysters_per_m2']:.2f} per m² of the sea floor seen near enough, "
            f"{result['shell_length_mm']:.0f} mm long on average ({result['shell_length_mm_low']:.0f} to "
            f"{result['shell_length_mm_high']:.0f}); {apart} can be told apart from above"
        )
    if "true_area_m2" in result:
        inside = "inside" if result["truth_in_interval"] else "outside"
        off = "" if result["area_error"] is None else f" ({100 * result['area_error']:+.1f} %)"
        lines.append(
            f"in truth oysters cover {result['true_area_m2']:.2f} m² of what was seen{off}, {inside} the interval, "
            f"and {result['true_area_of_reef_m2']:.2f} m² of the whole simulated reef; "
            f"{result['true_oysters']} oysters of {result['true_shell_length_mm']} mm were in sight"
        )
    if result["perception"] not in (RECORDED, EXACT):
        reefs = result["calibrated_reefs"]
        known = f"calibrated on {reefs} generated reefs, its errors there are in the interval"
        lines.append(
            f"oysters were recognized by a network ({result['perception']}): "
            f"{known if reefs else 'its errors are not in the interval'}"
        )
    if result["epsg"] is None:
        lines.append("not placed on Earth: --datum LAT,LON gives the latitude and longitude of the start")
    lines += [f"page: {result['page']}", f"files: {result['products']}"]
    return "\n".join(lines)

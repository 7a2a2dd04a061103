"""`coral reef map`: what a person takes home from a run or a recording, without driving anything."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

from coral.config import NonNegative, checked
from coral.errors import InputError, nearest
from coral.flags import Argument, Option
from coral.plugins import has_plugin
from coral.reef.eyes.backends import PAINTED, RGB, open_eyes
from coral.reef.eyes.doubt import DoubtCfg
from coral.reef.eyes.perception import RgbPerception
from coral.reef.products.files import summary, write_products
from coral.reef.products.picture_labels import write_labels
from coral.reef.products.placement import EarthPlacement, parse_datum
from coral.reef.products.product_files import ProductFiles
from coral.reef.products.survey_products import ProductsCfg, measure
from coral.reef.recordings.bag_recording import BagTopics
from coral.reef.recordings.find_recording import find_recording
from coral.reef.recordings.lens_check import check_lens
from coral.reef.recordings.picture_folder import TABLE
from coral.reef.recordings.recorded_pictures import PicturePerception
from coral.reef.recordings.recording import EXACT, RECORDED, Recording
from coral.reef.recordings.run_recording import is_run, true_reef
from coral.reef.world.world import ReefWorld
from coral.view.products_page import TruthComparison, write_products_page
from coral.words import many


@dataclass(frozen=True, kw_only=True)
class ReefMap:
    """Make maps, tables and pictures for an ecologist, and files for QGIS, from a run or a recorded dive."""

    recording: Annotated[Path, Argument(metavar="RECORDING")]
    """Run folder; folder of pictures with poses.csv, or of pictures or a video with a log (.tlog, .BIN); MCAP, bag."""
    out: Path | None = None
    """Folder of the map and the products, new or empty; of a run by default products/ in its folder."""
    camera: Annotated[Path | None, Option(metavar="FILE.yaml")] = None
    """The camera: width, height, and hfov_deg or fx, fy, cx, cy, model, distortion; pitch_down_deg, altitude_m. By
    default the recording's own."""
    perception: Annotated[str, Option(metavar="recorded|rgb|painted|FILE.onnx")] = RECORDED
    """Where classes and depth come from. recorded: pictures of classes and depth in the recording. rgb or
    painted: its colour pictures, by the network of CORAL for real or for painted ones. FILE.onnx, or the name of an
    entry point of the group `coral.eyes`: by yours."""
    depth: Annotated[Path | None, Option(metavar="FILE.onnx")] = None
    """A relative depth network (Depth Anything V2) whose depth replaces that of --perception, which still gives the
    classes."""
    period_s: NonNegative = 0.2
    """Shortest time between two pictures that are used (s); 0 uses all."""
    datum: Annotated[str | None, Option(metavar="LAT,LON[,HEADING]")] = None
    """Latitude and longitude of the first picture, or of a run's start (WGS 84, degrees), and the compass heading there
    if the x axis does not point east. A table with lat and lon has its own."""
    pictures_start_s: float | None = None
    """Time of the autopilot's log at which the first picture was taken or the video begins (s, as the log counts: since
    1970 in a .tlog, since the autopilot's start in most .BIN). By default both clocks agree."""
    topics: BagTopics = field(default_factory=BagTopics)
    """Topics of a bag or an MCAP file."""
    doubt: DoubtCfg = field(default_factory=DoubtCfg)
    """Doubt with which a pixel still counts, where a network states one; by default a run's own."""
    json: bool = False
    """Print one JSON object."""
    cfg: ProductsCfg = field(default_factory=ProductsCfg)
    """How products are made."""

    def __call__(self) -> Mapping[str, Any]:
        if self.pictures_start_s is not None and not math.isfinite(self.pictures_start_s):
            raise InputError("--pictures-start-s", "", self.pictures_start_s, "a number of seconds")
        if not 0.0 <= self.period_s < math.inf:
            raise InputError("--period-s", "", self.period_s, "0 seconds or more")
        of_run = is_run(self.recording)
        out = self._folder(of_run)
        truth = true_reef(self.recording) if of_run else None
        eyes = self._eyes(painted=truth is not None)
        named = self.perception if self.depth is None else f"{self.perception}, {self.depth}"
        recording = find_recording(
            self.recording,
            camera=self.camera,
            topics=self.topics,
            perception=None if eyes is None else PicturePerception(eyes, named),
            period_s=self.period_s,
            pictures_start_s=self.pictures_start_s,
        )
        if self.doubt != DoubtCfg():
            recording = replace(recording, map=replace(recording.map, doubt=checked(self.doubt, "--doubt")))
        if recording.datum is not None and self.datum is not None and (self.recording / TABLE).is_file():
            raise InputError("--datum", "", self.datum, f"none: {self.recording / TABLE} has lat and lon")
        made = make_products(recording, self.cfg, self.datum, out, truth, check_lens(recording))
        about = [*recording.remarks, *(() if eyes is None else eyes.about)]
        return {**made, "pictures_left_out": len(recording.omitted), "eyes": about}

    def _folder(self, of_run: bool) -> Path:
        if self.out is not None:
            return self.out
        if not of_run:
            raise InputError("--out", "", "nothing", "a new folder for the map and the products")
        if (out := self.recording / "products").is_symlink():  # whoever made the run chose where it leads
            raise InputError(str(out), "", "a link to another folder", "no such file, or --out FOLDER")
        return out

    def _eyes(self, *, painted: bool) -> RgbPerception | None:
        if self.perception == RECORDED:
            if self.depth is not None:
                expected = "--perception rgb, painted or FILE.onnx, for the classes"
                raise InputError("--depth", "", f"{self.depth} alone", expected)
            return None
        known = (RECORDED, RGB, PAINTED)
        given = self.perception.endswith(".onnx") or has_plugin("coral.eyes", self.perception)
        if self.perception not in known and not given:
            expected = f"{', '.join(known)} or FILE.onnx{nearest(self.perception, known)}"
            raise InputError("--perception", "", repr(self.perception), expected)
        return open_eyes(self.perception, depth=str(self.depth or ""), painted=painted and self.perception == PAINTED)

    def describe(self, result: Mapping[str, Any]) -> str:
        lines = [describe_products(result), *result["eyes"]]
        if result["pictures_left_out"]:
            lines.append(f"left out for want of a pose: {many(result['pictures_left_out'], 'picture')}")
        return "\n".join(lines)


def make_products(
    recording: Recording,
    cfg: ProductsCfg,
    datum: str | None,
    out: Path,
    true: ReefWorld | None,
    lens: str,
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

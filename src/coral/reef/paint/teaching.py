"""What a network is taught: painted reefs, collages, and real pictures with oysters marked."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.eyes.ground_plane import ground_depth, network_input
from coral.reef.generator.generate import GeneratorCfg, generate
from coral.reef.generator.spines import EVERY_TOPOLOGY
from coral.reef.paint.collage import BARE, CollagePainter, bare_picture
from coral.reef.paint.labelled_pictures import LabelledPicture
from coral.reef.paint.painter import Painter
from coral.reef.paint.viewpoints import choose_viewpoints
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.vehicle.camera import Camera, CameraCfg, ray_lengths
from coral.reef.world.geometry import Frame, Label
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import JERLOV, Rgb, WaterType

_REAL_PX = 480
"""Edge of real pictures in memory: more than the network reads, so that a part of one is still sharp."""
_REEFS_AT_A_TIME = 5
_SHARES = {"real": 0.5, "clumps": 0.14, "bare": 0.06}
"""Shares of a batch; painted reefs are the rest."""
FIRST_SEED = 500_000
"""Reefs to train on have seeds from here on; the shipped reefs and `gen:0` to `gen:39` have others."""
_WATERS = ("IB", "II", "1C", "3C", "5C")
"""From clear to murky: each picture's water lies between two neighbours of these."""
_FLOORS_M, _WAVES = (2.5, 5.0, 8.0), (0.0, 0.09)
"""Depths of the sea floor and slopes of waves: few, since every pair needs a film of caustics of its own."""
_A_DAY = 8
"""Pictures of a reef that share camera, water and light."""


@dataclass(frozen=True)
class PaintedReefs:
    """N pictures of painted reefs with what is true of them."""

    rgb: NDArray[np.uint8]
    """Shape=(N, H, W, 3)."""
    floor: NDArray[np.float16]
    """Inverse depth of a flat floor (1/m). Shape=(N, H, W)."""
    labels: NDArray[np.uint8]
    """`Label` of every pixel; surfaces beyond the water's visibility are water. Shape=(N, H, W)."""
    depth: NDArray[np.float16]
    """Metres, inf for water. Shape=(N, H, W)."""


@dataclass(frozen=True)
class MarkedPictures:
    """N pictures of one size with oysters marked."""

    rgb: NDArray[np.uint8]
    """Shape=(N, H, W, 3)."""
    target: NDArray[np.uint8]
    """`Label.OYSTER`, `OTHER` or `UNKNOWN`. Shape=(N, H, W)."""
    share: float
    """Of a batch."""


@dataclass(frozen=True)
class TrainingData:
    """All that a network learns from."""

    reefs: tuple[PaintedReefs, ...]
    """The larger pictures first."""
    marked: tuple[MarkedPictures, ...]
    titles: NDArray[np.uint8]
    """Coverage by letters and by their boxes, to write over pictures. Shape=(K, 2, h, w)."""
    size: tuple[int, int] = (240, 320)
    """Height and width that the network learns at where there are no reefs."""


def paint_reefs(
    seed: int, reefs: int, pictures: int, size: tuple[int, int], processes: int = 1,
    tell: Callable[[str], None] = print,
) -> PaintedReefs:  # fmt: skip
    """Paint pictures of a size (px) of generated reefs, several reefs at a time in processes of their own.

    The number of processes changes nothing; `tell` is called with a line now and then.
    """
    jobs = [(1000 * seed + k, min(_REEFS_AT_A_TIME, reefs - k), pictures, size)
            for k in range(0, reefs, _REEFS_AT_A_TIME)]  # fmt: skip
    parts: list[PaintedReefs] = []
    if processes == 1:
        parts = [_paint_some(job) for job in jobs]
    else:
        with ProcessPoolExecutor(processes, get_context("spawn")) as pool:
            for part in pool.map(_paint_some, jobs):
                parts.append(part)
                tell(f"{sum(len(one.rgb) for one in parts)} of {reefs * pictures} painted pictures")
    return PaintedReefs(
        np.concatenate([part.rgb for part in parts]),
        np.concatenate([part.floor for part in parts]),
        np.concatenate([part.labels for part in parts]),
        np.concatenate([part.depth for part in parts]),
    )


def draw_collages(seed: int, count: int, size: tuple[int, int], *, bare: bool = False) -> MarkedPictures:
    """Draw collages of shells, or of bare floors, each kind in turn."""
    rng = np.random.default_rng([seed, 0xC0])
    painter = CollagePainter(rng)
    kinds = list(BARE)
    made = [bare_picture(kinds[k % len(kinds)], size, rng) if bare else painter.clumps(size, rng) for k in range(count)]
    share = _SHARES["bare" if bare else "clumps"]
    return MarkedPictures(np.stack([one.rgb for one in made]), np.stack([one.target for one in made]), share)


def gather_real(pictures: Iterable[LabelledPicture]) -> MarkedPictures:
    """Return real pictures at one size."""
    size = (_REAL_PX, _REAL_PX)
    rgb: list[NDArray[np.uint8]] = [np.zeros((0, *size, 3), np.uint8)]
    target: list[NDArray[np.uint8]] = [np.zeros((0, *size), np.uint8)]
    for one in pictures:
        rgb.append(np.asarray(cv2.resize(one.rgb, size, interpolation=cv2.INTER_AREA), np.uint8)[None])
        target.append(np.asarray(cv2.resize(one.target, size, interpolation=cv2.INTER_NEAREST), np.uint8)[None])
    return MarkedPictures(np.concatenate(rgb), np.concatenate(target), _SHARES["real"])


def teach(
    seed: int, *, reefs: int, pictures: int, real: MarkedPictures | None, processes: int = 1,
    tell: Callable[[str], None] = print,
) -> TrainingData:  # fmt: skip
    """Make the data of a training: pictures of painted reefs, of the same number again at half size, and real ones.

    Several processes paint; `tell` is called with a line now and then.
    """
    full, half = (320, 240), (160, 120)
    painted = tuple(
        paint_reefs(seed + k, reefs, pictures, size, processes, tell) for k, size in enumerate((full, half))
    )
    count = max(reefs * pictures // 4, 16)
    marked = [draw_collages(seed, count, full), draw_collages(seed + 1, count // 3, full, bare=True)]
    if real is not None and len(real.rgb):
        marked.append(real)
    return TrainingData(painted, tuple(marked), draw_titles(seed, 48, full))


def draw_titles(seed: int, count: int, size: tuple[int, int]) -> NDArray[np.uint8]:
    """Draw lines of letters as videos have them, and the boxes behind them. Shape=(count, 2, H, W)."""
    rng = np.random.default_rng([seed, 0x71])
    letters = np.array(list("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789.,:-   "))
    out = np.zeros((count, 2, size[1], size[0]), np.uint8)
    for cover in out:
        for _ in range(int(rng.integers(1, 4))):
            text = "".join(rng.choice(letters, int(rng.integers(4, 40))))
            scale, thick = float(rng.uniform(0.3, 1.0)), int(rng.integers(1, 3))
            (width, height), below = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, scale, thick)
            x, y = int(rng.uniform(-0.2, 0.8) * size[0]), int(rng.uniform(0.05, 1.0) * size[1])
            cv2.rectangle(cover[1], (x - 3, y - height - 3), (x + width + 3, y + below), 255, -1)
            cv2.putText(cover[0], text, (x, y), cv2.FONT_HERSHEY_SIMPLEX, scale, 255, thick, cv2.LINE_AA)
    return out


def _paint_some(job: tuple[int, int, int, tuple[int, int]]) -> PaintedReefs:
    """Paint pictures of some reefs; the seed is of reefs, poses, water and light."""
    seed, reefs, pictures, size = job
    rng = np.random.default_rng([seed, 0xE1E5])
    taken = list[tuple[NDArray[Any], ...]]()
    for number in range(reefs):
        scene = _make_scene(FIRST_SEED + 1000 * seed + number, rng)
        for first in range(0, pictures, _A_DAY):
            taken += _take_pictures(scene, size, min(_A_DAY, pictures - first), rng)
    rgb, floor, labels, depth = (np.stack(part) for part in zip(*taken, strict=True))
    return PaintedReefs(rgb, floor.astype(np.float16), labels, depth.astype(np.float16))


def hide_beyond(frame: Frame, camera: CameraCfg, visibility_m: float) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Return labels and depth of what can be seen through water: surfaces farther than that are water."""
    hidden = ~(frame.depth * np.float32(ray_lengths(camera)) <= visibility_m)
    labels = np.where(hidden, np.uint8(Label.WATER), frame.labels).astype(np.uint8)
    return labels, np.where(hidden, np.float32(np.inf), frame.depth).astype(np.float32)


def _make_scene(seed: int, rng: np.random.Generator) -> Scene:
    while True:
        cfg = GeneratorCfg(
            topology=EVERY_TOPOLOGY[rng.integers(len(EVERY_TOPOLOGY))],
            size_m=(float(rng.uniform(20, 26)),) * 2,
            clusters=int(rng.integers(4, 8)),
            obstacles=int(rng.integers(20, 45)),
            barriers=int(rng.integers(0, 2)),
            seed=seed,
        )
        try:
            return Scene.from_world(generate(cfg))
        except InputError:
            seed += 1_000_000  # more was asked for than fits


def _take_pictures(
    scene: Scene, size: tuple[int, int], count: int, rng: np.random.Generator
) -> Iterator[tuple[NDArray[np.uint8], NDArray[np.float32], NDArray[np.uint8], NDArray[np.float32]]]:
    """Yield pictures as fields of `PaintedReefs`."""
    camera = CameraCfg(
        width=size[0],
        height=size[1],
        altitude_m=float(rng.choice([1.0, rng.uniform(0.5, 1.8)])),
        pitch_down_deg=float(rng.choice([15.0, rng.uniform(5.0, 35.0), rng.uniform(35.0, 90.0)], p=[0.5, 0.4, 0.1])),
        hfov_deg=float(rng.choice([120.0, rng.uniform(80.0, 120.0)])),
    )
    water = _mix_water(rng)
    caster = Camera(scene, camera)
    painter = Painter(scene, camera, water, _vary_light(rng), seed=int(rng.integers(2**31)))
    for _ in range(count):
        roll, pitch = (float(angle) for angle in rng.choice([0.0, 1.0]) * rng.normal(0.0, 0.06, 2))
        wanted = Label.OYSTER if rng.random() < 0.5 else Label.OBSTACLE
        (pose,) = choose_viewpoints(scene, 1, rng, wanted=wanted, aside_rad=0.5, free_m=0.3)
        frame = caster.render(pose, roll=roll, pitch=pitch)
        velocity = (float(rng.uniform(0.0, 0.6)), float(rng.normal(0.0, 0.05)), float(rng.normal(0.0, 0.3)))
        rgb = painter.paint(frame, pose, roll=roll, pitch=pitch, t=float(rng.uniform(0.0, 600.0)), velocity=velocity)
        labels, depth = hide_beyond(frame, camera, water.visibility_m)
        yield rgb, network_input(rgb, ground_depth(camera, roll=roll, pitch=pitch))[3], labels, depth


def _vary_light(rng: np.random.Generator) -> PainterCfg:
    return PainterCfg(
        water_depth_m=float(rng.choice(_FLOORS_M)),
        sun_elevation_deg=float(rng.uniform(20.0, 85.0)),
        sun_azimuth_deg=float(rng.uniform(-180.0, 180.0)),
        sky_share=float(rng.uniform(0.2, 0.9)),
        wave_slope=float(rng.choice(_WAVES)),
        forward_blur_deg=float(rng.uniform(1.0, 3.5)),
        snow=float(rng.uniform(0.0, 2.0)),
        lens_blur_px=float(rng.uniform(0.2, 0.8)),
        vignette=float(rng.uniform(0.0, 0.5)),
        exposure=float(rng.uniform(0.1, 0.3)),
        white_balance=float(rng.uniform(0.0, 1.0)),
        photons=float(10 ** rng.uniform(3.3, 4.5)),
        read_noise=float(rng.uniform(0.001, 0.01)),
    )


def _mix_water(rng: np.random.Generator) -> WaterType:
    k, share = int(rng.integers(len(_WATERS) - 1)), float(rng.random())
    first, second = (JERLOV[f"jerlov-{name}"] for name in _WATERS[k : k + 2])

    def between(a: Rgb, b: Rgb) -> Rgb:
        red, green, blue = ((1 - share) * x + share * y for x, y in zip(a, b, strict=True))
        return red, green, blue

    return WaterType(
        name="mixed",
        absorption=between(first.absorption, second.absorption),
        scattering=between(first.scattering, second.scattering),
        diffuse=between(first.diffuse, second.diffuse),
    )

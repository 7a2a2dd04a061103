"""Pictures to train on: generated reefs, cameras, waters and light at random."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.eyes.ground_plane import ground_depth, network_input
from coral.reef.generator.generate import GeneratorCfg, generate
from coral.reef.generator.spines import EVERY_TOPOLOGY
from coral.reef.paint.painter import Painter
from coral.reef.paint.viewpoints import choose_viewpoints
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.vehicle.camera import Camera, CameraCfg, ray_lengths
from coral.reef.world.geometry import Frame, Label
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import JERLOV, Rgb, WaterType

FIRST_SEED = 500_000
"""Reefs to train on have seeds from here on; the shipped reefs and `gen:0` to `gen:39` have others."""
_WATERS = ("IB", "II", "1C", "3C", "5C")
"""From clear to murky: each picture's water lies between two neighbours of these."""
_FLOORS_M, _WAVES = (2.5, 5.0, 8.0), (0.0, 0.09)
"""Depths of the sea floor and slopes of waves: few, since every pair needs a film of caustics of its own."""
_A_DAY = 8
"""Pictures of a reef that share camera, water and light."""


@dataclass(frozen=True)
class Sample:
    """One picture with what is true of it."""

    picture: NDArray[np.float32]
    """Of `network_input`. Shape=(4, H, W)."""
    labels: NDArray[np.uint8]
    """`Label` of every pixel; surfaces beyond the water's visibility are water. Shape=(H, W)."""
    depth: NDArray[np.float32]
    """Depth (m), inf where the label is water. Shape=(H, W)."""


def make_samples(seed: int, worlds: int, pictures: int, size: tuple[int, int] = (160, 120)) -> Iterator[Sample]:
    """Yield pictures of a size (px) of generated reefs; `seed` is of reefs, poses, water and light."""
    rng = np.random.default_rng([seed, 0xE1E5])
    for number in range(worlds):
        scene = _make_scene(FIRST_SEED + 1000 * seed + number, rng)
        for first in range(0, pictures, _A_DAY):
            yield from _take_samples(scene, size, min(_A_DAY, pictures - first), rng)


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


def _take_samples(scene: Scene, size: tuple[int, int], count: int, rng: np.random.Generator) -> Iterator[Sample]:
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
        yield Sample(network_input(rgb, ground_depth(camera, roll=roll, pitch=pitch)), labels, depth)


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

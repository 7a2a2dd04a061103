"""Builds a reef in Blender and renders it with Cycles. Runs where bpy is, and imports nothing of this package.

Usage: python blender_script.py JOB.json. The job is written by `blender_scene.py`, which describes every field.
"""

from __future__ import annotations

import json
import math
import os
import sys
from typing import Any

import numpy as np

FLOOR_INDEX, FIRST_INDEX = 1, 2
"""Object index of the sea floor and of the first solid; 0 is nothing."""


def main(path: str) -> None:
    """Build the scene of a job, save it, and render its views."""
    import bpy

    with open(path, encoding="utf-8") as file:
        job = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    build(bpy, job)
    if job["blend"]:
        bpy.ops.wm.save_as_mainfile(filepath=job["blend"], compress=True)
    for view in job["views"]:
        render(bpy, job, view)
        print(json.dumps({"rendered": view["name"]}), flush=True)


def build(bpy: Any, job: dict[str, Any]) -> None:
    """Fill an empty Blender file with camera, light, water, sea floor and solids."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.unit_settings.system = "METRIC"
    scene.view_settings.view_transform, scene.view_settings.exposure = "Standard", 2.5
    scene.cycles.samples, scene.cycles.use_denoising = job["samples"], job["denoise"]
    camera, sun, water = job["camera"], job["sun"], job["water"]
    scene.render.resolution_x, scene.render.resolution_y = camera["width"], camera["height"]
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.angle = "HORIZONTAL", math.radians(camera["hfov_deg"])
    lens.clip_start, lens.clip_end = camera["near_m"], 200.0
    scene.camera = _add(bpy, "camera", lens)
    # A lamp shines along its own -z. The sky is a second sun, as wide as Snell's window; a real background would reach
    # surfaces by other rays than shadow rays, and these alone know daylight's own attenuation.
    x, y, z = sun["direction"]
    for name, energy, angle, turn in (
        ("sun", sun["energy"], 1.0, (0.0, math.acos(z), math.atan2(y, x))),
        ("sky", sun["sky_energy"], 97.0, (0.0, 0.0, 0.0)),
    ):
        lamp = bpy.data.lights.new(name, "SUN")
        lamp.energy, lamp.angle = energy, math.radians(angle)
        _add(bpy, name, lamp).rotation_euler = turn
    world = bpy.data.worlds.new("beyond")
    scene.world, world.color = world, (0.0, 0.0, 0.0)
    floor_z = job["floor"]["z_m"]
    _floor(bpy, job["floor"])
    ball, cube, can = _ball(bpy), _cube(bpy), _can(bpy)
    made: dict[str, Any] = {}
    for i, solid in enumerate(job["solids"]):
        shape = {"ellipsoid": ball, "box": cube, "cylinder": can}[solid["shape"]]
        kind = solid["material"]
        if kind not in made:
            made[kind] = (_copy(shape, kind), _material(bpy, kind))
            made[kind][0].materials.append(made[kind][1])
        thing = _add(bpy, f"{kind}.{i:04d}", made[kind][0])
        thing.matrix_world = _matrix(solid)
        thing.color = (*solid["paint"], 1.0)
        thing.pass_index = FIRST_INDEX + i
    _debris(bpy, job)
    _water(bpy, water, floor_z)
    if job["caustics"]:
        _gobo(bpy, job["caustics"], floor_z + water["depth_m"])


def render(bpy: Any, job: dict[str, Any], view: dict[str, Any]) -> None:
    """Render one view: light, depth and object index, as a NumPy archive."""
    scene = bpy.context.scene
    scene.camera.matrix_world = _rows(view["T_world_camera"])
    folder = job["folder"]
    settings, cycles = scene.render.image_settings, scene.cycles
    settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGB"
    scene.render.use_file_extension = False
    scene.render.threads_mode, scene.render.threads = "FIXED", job["threads"]
    cycles.device, cycles.seed = "CPU", view["seed"]
    cycles.samples, cycles.use_adaptive_sampling = job["samples"], False
    cycles.use_denoising = job["denoise"]
    cycles.max_bounces, cycles.diffuse_bounces, cycles.volume_bounces = 3, 2, 1
    cycles.transparent_max_bounces = 8
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 1.5
    light = _render(bpy, os.path.join(folder, "light.exr"))
    # The second time every surface glows with its distance and number, seen through the middle of each pixel.
    hidden = [thing for thing in bpy.data.objects if thing.name in ("water", "gobo")]
    for thing in hidden:
        thing.hide_render = True
    layer = bpy.context.view_layer
    layer.material_override = _measure(bpy)
    cycles.samples, cycles.use_denoising, cycles.pixel_filter_type = 1, False, "BOX"
    cycles.filter_width = 0.01
    measured = _render(bpy, os.path.join(folder, "measured.exr"))
    layer.material_override = None
    for thing in hidden:
        thing.hide_render = False
    np.savez_compressed(
        os.path.join(folder, view["name"] + ".npz"),
        light=light,
        depth=measured[..., 0],
        index=np.round(measured[..., 1]).astype(np.int32),
    )


def _render(bpy: Any, path: str) -> np.ndarray[Any, Any]:
    bpy.context.scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    os.remove(path)
    # Blender counts rows from below.
    return np.ascontiguousarray(pixels.reshape(height, width, -1)[::-1, :, :3])


def _add(bpy: Any, name: str, data: Any) -> Any:
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def _rows(matrix: list[list[float]]) -> Any:
    from mathutils import Matrix

    return Matrix(matrix)


def _matrix(solid: dict[str, Any]) -> Any:
    """Return the matrix that makes a unit solid the one described."""
    turn, half, center = solid["rotation"], solid["half"], solid["center"]
    rows = [[turn[i][j] * half[j] for j in range(3)] + [center[i]] for i in range(3)]
    return _rows([*rows, [0.0, 0.0, 0.0, 1.0]])


def _mesh(bpy: Any, name: str, fill: Any, smooth: bool) -> Any:
    import bmesh

    mesh, parts = bpy.data.meshes.new(name), bmesh.new()
    fill(bmesh.ops, parts)
    for face in parts.faces:
        face.smooth = smooth
    parts.to_mesh(mesh)
    parts.free()
    return mesh


def _ball(bpy: Any) -> Any:
    return _mesh(bpy, "ball", lambda ops, to: ops.create_icosphere(to, subdivisions=5, radius=1.0), True)


def _cube(bpy: Any) -> Any:
    return _mesh(bpy, "cube", lambda ops, to: ops.create_cube(to, size=2.0), False)


def _can(bpy: Any) -> Any:
    return _mesh(
        bpy,
        "can",
        lambda ops, to: ops.create_cone(to, cap_ends=True, segments=96, radius1=1.0, radius2=1.0, depth=2.0),
        False,
    )


def _copy(mesh: Any, name: str) -> Any:
    copied = mesh.copy()
    copied.name = name
    return copied


class _Nodes:
    """The nodes of one material, wired in few words."""

    def __init__(self, bpy: Any, name: str) -> None:
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.tree.nodes.clear()
        self.output = self.tree.nodes.new("ShaderNodeOutputMaterial")

    def add(self, kind: str, inputs: dict[Any, Any] | None = None, **settings: Any) -> Any:
        """Add a node. Inputs that are sockets are linked; others are values."""
        node = self.tree.nodes.new("ShaderNode" + kind)
        for key, value in settings.items():
            setattr(node, key, value)
        for key, value in (inputs or {}).items():
            if hasattr(value, "is_output"):
                self.tree.links.new(value, node.inputs[key])
            else:
                node.inputs[key].default_value = value
        return node

    def noise(self, where: Any, scale: float, detail: float = 6.0, rough: float = 0.6) -> Any:
        inputs = {"Vector": where, "Scale": scale, "Detail": detail, "Roughness": rough}
        return self.add("TexNoise", inputs).outputs["Factor" if self._new("TexNoise", "Factor") else "Fac"]

    def _new(self, kind: str, name: str) -> bool:
        node = self.tree.nodes.new("ShaderNode" + kind)
        there = name in node.outputs
        self.tree.nodes.remove(node)
        return there

    def math(self, operation: str, *values: Any) -> Any:
        return self.add("Math", dict(enumerate(values)), operation=operation).outputs[0]

    def ramp(self, value: Any, low: float, high: float) -> Any:
        inputs = {"Value": value, "From Min": low, "From Max": high}
        return self.add("MapRange", inputs, interpolation_type="SMOOTHSTEP").outputs["Result"]

    def tint(self, colour: Any, by: Any) -> Any:
        """Multiply a colour by a number."""
        return self.add("VectorMath", {0: colour, "Scale": by}, operation="SCALE").outputs[0]

    def blend(self, share: Any, first: Any, second: Any) -> Any:
        node = self.add("Mix", data_type="RGBA")
        pairs = ((node.inputs[0], share), (node.inputs[6], first), (node.inputs[7], second))
        for socket, value in pairs:
            if hasattr(value, "is_output"):
                self.tree.links.new(value, socket)
            else:
                socket.default_value = value
        return node.outputs[2]

    def finish(self, colour: Any, height: Any, strength: float, distance: float, rough: float = 0.85) -> Any:
        bump = self.add("Bump", {"Height": height, "Strength": strength, "Distance": distance}).outputs["Normal"]
        surface = self.add("BsdfPrincipled", {"Base Color": colour, "Roughness": rough, "Normal": bump})
        self.tree.links.new(surface.outputs[0], self.output.inputs["Surface"])
        return self.material


def _floor(bpy: Any, floor: dict[str, Any]) -> None:
    x, y = floor["middle"]
    mesh = _mesh(bpy, "floor", lambda ops, to: ops.create_grid(to, x_segments=1, y_segments=1, size=100.0), False)
    thing = _add(bpy, "floor", mesh)
    thing.location, thing.pass_index = (x, y, floor["z_m"]), FLOOR_INDEX
    nodes = _Nodes(bpy, "sand")
    where = nodes.add("NewGeometry").outputs["Position"]
    clouds, grain = nodes.noise(where, 0.6), nodes.noise(where, 45.0, 3.0, 0.8)
    ripples = nodes.add(
        "TexWave",
        {"Vector": where, "Scale": 2.1, "Distortion": 3.5, "Detail": 2.0, "Detail Scale": 0.4},
        wave_type="BANDS",
        bands_direction="DIAGONAL",
        wave_profile="SIN",
    ).outputs[1]
    patches = nodes.ramp(clouds, 0.42, 0.6)
    stones = nodes.ramp(nodes.noise(where, 22.0, 2.0, 0.5), 0.62, 0.7)
    red, green, blue = floor["sand"]
    light = nodes.math("ADD", nodes.math("MULTIPLY_ADD", clouds, 0.7, 0.45), nodes.math("MULTIPLY", grain, 0.35))
    colour = nodes.tint(nodes.blend(clouds, (0.6 * red, 0.66 * green, 0.7 * blue, 1), (red, green, blue, 1)), light)
    colour = nodes.blend(nodes.math("MULTIPLY", stones, 0.7), colour, (0.16, 0.15, 0.13, 1.0))
    height = nodes.math("ADD", nodes.math("MULTIPLY", ripples, patches), nodes.math("MULTIPLY", grain, 0.35))
    mesh.materials.append(nodes.finish(colour, height, 0.8, 0.02))


def _material(bpy: Any, kind: str) -> Any:
    nodes = _Nodes(bpy, kind)
    about = nodes.add("ObjectInfo")
    local = nodes.add("TexCoord").outputs["Object"]
    moved = nodes.add("VectorMath", {0: local, 1: about.outputs["Location"]}, operation="ADD").outputs[0]
    position = nodes.add("NewGeometry").outputs["Position"]
    paint = about.outputs["Color"]
    if kind == "shell":
        hinge = nodes.add("VectorMath", {0: local, 1: (1.05, 0.0, 0.0)}, operation="ADD").outputs[0]
        crumple = nodes.noise(moved, 1.6)
        away = nodes.add("VectorMath", {0: hinge}, operation="LENGTH").outputs["Value"]
        turns = nodes.math("ADD", nodes.math("MULTIPLY", away, 6.5), nodes.math("MULTIPLY", crumple, 3.0))
        ring = nodes.math("FRACT", turns)
        mottle = nodes.noise(moved, 4.0, 8.0, 0.7)
        light = nodes.math("ADD", nodes.math("MULTIPLY", mottle, 1.1), nodes.math("MULTIPLY", ring, 0.45))
        dirt = nodes.ramp(nodes.noise(moved, 2.3), 0.5, 0.68)
        colour = nodes.blend(nodes.math("MULTIPLY", dirt, 0.65), nodes.tint(paint, light), (0.11, 0.12, 0.06, 1.0))
        colour = nodes.blend(nodes.math("MULTIPLY", nodes.ramp(away, 1.7, 2.05), 0.5), colour, (0.55, 0.52, 0.45, 1.0))
        return nodes.finish(colour, nodes.math("ADD", ring, mottle), 0.9, 0.012, 0.7)
    if kind == "rock":
        rough, pits = nodes.noise(position, 3.0, 10.0, 0.65), nodes.noise(position, 14.0, 4.0)
        light = nodes.math("MULTIPLY_ADD", rough, 1.4, 0.2)
        algae = nodes.ramp(nodes.noise(position, 5.0), 0.5, 0.7)
        colour = nodes.blend(nodes.math("MULTIPLY", algae, 0.7), nodes.tint(paint, light), (0.07, 0.10, 0.04, 1.0))
        return nodes.finish(colour, nodes.math("ADD", rough, nodes.math("MULTIPLY", pits, 0.4)), 1.0, 0.06)
    if kind == "pile":
        stretched = nodes.add("Mapping", {"Vector": position, "Scale": (1.0, 1.0, 0.12)}).outputs[0]
        grain, spots = nodes.noise(stretched, 18.0, 6.0, 0.7), nodes.noise(position, 16.0, 2.0)
        lime = nodes.ramp(spots, 0.6, 0.66)
        colour = nodes.blend(lime, nodes.tint(paint, nodes.math("MULTIPLY", grain, 2.0)), (0.42, 0.40, 0.34, 1.0))
        return nodes.finish(colour, nodes.math("ADD", grain, lime), 0.8, 0.015)
    if kind == "buoy":
        dirt = nodes.noise(position, 6.0)
        return nodes.finish(nodes.tint(paint, nodes.math("MULTIPLY_ADD", dirt, 0.3, 0.85)), dirt, 0.05, 0.002, 0.35)
    stains, pores = nodes.noise(position, 2.0), nodes.noise(position, 40.0, 2.0)
    algae = nodes.ramp(nodes.noise(position, 6.0), 0.5, 0.75)
    colour = nodes.tint(paint, nodes.math("MULTIPLY_ADD", stains, 0.9, 0.5))
    colour = nodes.blend(nodes.math("MULTIPLY", algae, 0.6), colour, (0.08, 0.11, 0.05, 1.0))
    return nodes.finish(colour, pores, 0.5, 0.006)


def _debris(bpy: Any, job: dict[str, Any]) -> None:
    """Scatter bits of shell around the oysters, tilted a little, as one object with the index of the sea floor."""
    shells = [solid["center"] for solid in job["solids"] if solid["material"] == "shell"]
    if not shells:
        return
    rng = np.random.default_rng(job["seed"])
    spots = np.array(shells)[rng.integers(0, len(shells), 6 * len(shells)), :2]
    spots = spots + rng.normal(0.0, 0.22, spots.shape)
    corners: list[tuple[float, float, float]] = []
    faces: list[tuple[int, ...]] = []
    for (x, y), size, spin, tilt in zip(
        spots,
        rng.uniform(0.008, 0.03, len(spots)),
        rng.uniform(0, 2 * np.pi, len(spots)),
        rng.normal(0.0, 0.15, (len(spots), 2)),
        strict=True,
    ):
        first = len(corners)
        for k, wide in enumerate((1.0, 0.55, 1.0, 0.7, 0.9)):
            angle = spin + 2 * np.pi * k / 5
            dx, dy = size * wide * np.cos(angle), 0.7 * size * wide * np.sin(angle)
            corners.append((x + dx, y + dy, job["floor"]["z_m"] + 0.004 + max(tilt[0] * dx + tilt[1] * dy, -0.003)))
        faces.append(tuple(range(first, first + 5)))
    mesh = bpy.data.meshes.new("debris")
    mesh.from_pydata(corners, [], faces)
    thing = _add(bpy, "debris", mesh)
    thing.pass_index = FLOOR_INDEX
    nodes = _Nodes(bpy, "debris")
    where = nodes.add("NewGeometry").outputs["Position"]
    spots_ = nodes.noise(where, 9.0)
    mesh.materials.append(
        nodes.finish(nodes.blend(spots_, (0.34, 0.32, 0.27, 1.0), (0.62, 0.59, 0.52, 1.0)), spots_, 0.2, 0.002)
    )


def _water(bpy: Any, water: dict[str, Any], floor_z: float) -> None:
    """Fill the space above the floor with a volume that scatters and absorbs.

    Light on its way from the lamp is attenuated as daylight is (K_d): what scattering takes from the straight beam
    comes down on other ways, which so few bounces would lose.
    """
    mesh = _mesh(bpy, "water", lambda ops, to: ops.create_cube(to, size=2.0), False)
    thing = _add(bpy, "water", mesh)
    depth = water["depth_m"]
    thing.scale, thing.location = (95.0, 95.0, 0.5 * depth + 0.5), (0.0, 0.0, floor_z + 0.5 * depth - 0.5)
    thing.location.x, thing.location.y = water["middle"]
    nodes = _Nodes(bpy, "water")
    shadow = nodes.add("LightPath").outputs["Is Shadow Ray"]
    scattering, absorption, diffuse = (np.array(water[key]) for key in ("scattering", "absorption", "diffuse"))
    most = max(float(scattering.max()), 1e-6)
    thin = nodes.math("MULTIPLY", nodes.math("SUBTRACT", 1.0, shadow), most)
    scatter = nodes.add(
        "VolumeScatter",
        {"Color": (*(scattering / most), 1.0), "Density": thin, "Anisotropy": water["anisotropy"]},
    )
    # Absorption of density D and colour C is D (1 - C).
    strong = max(float(absorption.max()), float(diffuse.max()))
    colour = nodes.blend(shadow, (*(1 - absorption / strong), 1.0), (*(1 - diffuse / strong), 1.0))
    absorb = nodes.add("VolumeAbsorption", {"Color": colour, "Density": strong})
    both = nodes.add("AddShader", {0: scatter.outputs[0], 1: absorb.outputs[0]})
    nodes.tree.links.new(both.outputs[0], nodes.output.inputs["Volume"])
    mesh.materials.append(nodes.material)
    thing.display_type = "WIRE"


def _gobo(bpy: Any, caustics: dict[str, Any], z: float) -> None:
    """Hang a slide with the pattern of the caustics under the sun: it dims every ray as the waves would."""
    pattern = np.load(caustics["path"])
    n, most = len(pattern), caustics["most"]
    image = bpy.data.images.new("caustics", n, n, float_buffer=True)
    values = np.ones((n, n, 4), np.float32)
    values[..., :3] = np.clip(pattern / most, 0.0, 1.0)[..., None]
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(values.ravel())
    image.pack()
    mesh = _mesh(bpy, "gobo", lambda ops, to: ops.create_grid(to, x_segments=1, y_segments=1, size=90.0), False)
    thing = _add(bpy, "gobo", mesh)
    thing.location = (*caustics["middle"], z + 0.02)
    nodes = _Nodes(bpy, "gobo")
    where = nodes.add("NewGeometry").outputs["Position"]
    scaled = nodes.add("Mapping", {"Vector": where, "Scale": (1.0 / caustics["tile_m"],) * 3}).outputs[0]
    slide = nodes.add("TexImage", {"Vector": scaled})
    slide.image, slide.extension = image, "REPEAT"
    clear = nodes.add("BsdfTransparent", {"Color": slide.outputs["Color"]})
    nodes.tree.links.new(clear.outputs[0], nodes.output.inputs["Surface"])
    mesh.materials.append(nodes.material)
    thing.visible_camera = thing.visible_diffuse = False


def _measure(bpy: Any) -> Any:
    """Return a material that glows with (depth along the optical axis, object index, 0)."""
    nodes = _Nodes(bpy, "measure")
    depth = nodes.add("CameraData").outputs["View Z Depth"]
    index = nodes.add("ObjectInfo").outputs["Object Index"]
    both = nodes.add("CombineXYZ", {0: depth, 1: index, 2: 0.0})
    glow = nodes.add("Emission", {"Color": both.outputs[0], "Strength": 1.0})
    nodes.tree.links.new(glow.outputs[0], nodes.output.inputs["Surface"])
    return nodes.material


if __name__ == "__main__":
    main(sys.argv[-1])

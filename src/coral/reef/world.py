"""A reef world is a file: seabed, oyster clusters, obstacles, start pose, current, seed.

Frames: world ENU, metres, z up, seabed at `seabed.z_m`; x in [0, size_m[0]], y in [0, size_m[1]].
Angles in radians, counter-clockwise, 0 along +x.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from coral.config import read_yaml
from coral.errors import InputError, nearest

WORLDS_DIR = Path(__file__).parent / "worlds"
FORMAT = "coral-reef/1"
MAX_AREA_M2 = 10_000
MAX_OBJECTS = 20_000

Metres = Annotated[float, Field(gt=0, le=1000)]
Coordinate = Annotated[float, Field(ge=-1000, le=1000)]
Angle = Annotated[float, Field(ge=-7, le=7)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Seabed(_Part):
    """Flat sea floor."""

    z_m: Coordinate = 0.0


class Start(_Part):
    """Where the vehicle begins, heading `theta` (rad)."""

    x: Coordinate
    y: Coordinate
    theta: Angle = 0.0


class Current(_Part):
    """Steady ocean current: the water's velocity in the world frame (m/s)."""

    x_m_s: float = Field(default=0.0, ge=-1, le=1)
    y_m_s: float = Field(default=0.0, ge=-1, le=1)


class Oyster(_Part):
    """One oyster: an ellipsoid with half-axes `radii` (m), turned by roll, pitch, yaw (rad, z-y-x)."""

    x: Coordinate
    y: Coordinate
    z: Coordinate
    radii: tuple[Metres, Metres, Metres]
    rpy: tuple[Angle, Angle, Angle] = (0.0, 0.0, 0.0)


class Cluster(_Part):
    """Oysters that settled together; what coverage is counted in."""

    name: str = Field(min_length=1, max_length=40)
    oysters: tuple[Oyster, ...] = Field(min_length=1)


class Obstacle(_Part):
    """Something to keep clear of. `size`: half-extents (m) along its own axes.

    sphere: (r, r, r); ellipsoid: half-axes; cylinder (upright): (r, r, half height); box: half edges.
    """

    shape: Literal["sphere", "ellipsoid", "cylinder", "box"]
    x: Coordinate
    y: Coordinate
    z: Coordinate
    size: tuple[Metres, Metres, Metres]
    yaw: Angle = 0.0

    @model_validator(mode="after")
    def _round_shapes_are_round(self) -> Obstacle:
        a, b, c = self.size
        if self.shape == "sphere" and not a == b == c:
            raise ValueError("a sphere has three equal half-extents")
        if self.shape == "cylinder" and a != b:
            raise ValueError("a cylinder has two equal radii: (r, r, half height)")
        return self


class ReefWorld(_Part):
    """A whole environment, as read from a YAML file."""

    format: Literal["coral-reef/1"] = FORMAT
    name: str = Field(min_length=1, max_length=60)
    topology: Literal["L", "S", "K", "E", "O", "custom"] = "custom"
    size_m: tuple[Metres, Metres]
    seabed: Seabed = Seabed()
    start: Start
    current: Current = Current()
    clusters: tuple[Cluster, ...] = Field(min_length=1)
    obstacles: tuple[Obstacle, ...] = ()
    seed: int = Field(default=0, ge=0)
    spine: tuple[tuple[tuple[float, float], ...], ...] = ()
    """Polylines (m) that the reef was grown along; for drawings only, no decision reads them."""


def shipped_worlds() -> list[str]:
    """Names of the reefs that come with the package, topology by topology."""
    order = {letter: k for k, letter in enumerate("lskeo")}
    names = [path.stem for path in WORLDS_DIR.glob("*.yaml")]
    return sorted(names, key=lambda name: (order.get(name[0], 9), name))


def load_world(name: str | Path) -> ReefWorld:
    """Read a shipped reef by name, or any world file by path, and check it.

    Raises:
        InputError: There is no such world, or the file is broken or describes an impossible mission.
    """
    text = str(name)
    path = WORLDS_DIR / f"{text}.yaml" if text in shipped_worlds() else Path(text)
    if not path.exists() and path.suffix not in (".yaml", ".yml"):
        known = shipped_worlds()
        raise InputError("world", "", repr(text), f"a YAML file or one of {', '.join(known)}{nearest(text, known)}")
    content = read_yaml(path)
    try:
        world = ReefWorld.model_validate(content)
    except ValidationError as error:
        raise _input_error(str(path), error) from None
    check_world(world, str(path))
    return world


def save_world(world: ReefWorld, path: Path, comment: str = "") -> None:
    """Write a world as YAML: one oyster or obstacle a line, millimetres and milliradians kept."""
    content = _rounded(world.model_dump(mode="json"))
    clusters, obstacles, spine = content.pop("clusters"), content.pop("obstacles"), content.pop("spine")
    lines = [f"# {line}" for line in comment.splitlines()]
    lines += [f"{key}: {_flow(value)}" for key, value in content.items()]
    lines.append("spine:" if spine else "spine: []")
    lines += [f"  - {_flow(line)}" for line in spine]
    lines.append("clusters:")
    for cluster in clusters:
        lines += [f"  - name: {_flow(cluster['name'])}", "    oysters:"]
        lines += [f"      - {_flow(oyster)}" for oyster in cluster["oysters"]]
    lines.append("obstacles:" if obstacles else "obstacles: []")
    lines += [f"  - {_flow(obstacle)}" for obstacle in obstacles]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def world_schema() -> dict[str, Any]:
    """JSON schema of a world file."""
    return ReefWorld.model_json_schema()


def check_world(world: ReefWorld, where: str) -> None:
    """Check what single values cannot show: bounds, a free start, every cluster reachable.

    Raises:
        InputError: Naming the field that is at fault.
    """
    from coral.reef.collision import nearest as nearest_footprint
    from coral.reef.reachability import HULL_RADIUS_M, unreachable_clusters
    from coral.reef.scene import Scene

    width, height = world.size_m
    if width * height > MAX_AREA_M2:
        raise InputError(where, "size_m", f"{width:g} x {height:g} m", f"at most {MAX_AREA_M2} square metres")
    count = len(world.obstacles) + sum(len(c.oysters) for c in world.clusters)
    if count > MAX_OBJECTS:
        raise InputError(where, "clusters", f"{count} oysters and obstacles", f"at most {MAX_OBJECTS}")

    def inside(field: str, x: float, y: float) -> None:
        if not (0 <= x <= width and 0 <= y <= height):
            raise InputError(where, field, f"({x:g}, {y:g})", f"a point within 0..{width:g}, 0..{height:g} m (size_m)")

    inside("start", world.start.x, world.start.y)
    for i, cluster in enumerate(world.clusters):
        for j, oyster in enumerate(cluster.oysters):
            inside(f"clusters[{i}].oysters[{j}]", oyster.x, oyster.y)
    for i, obstacle in enumerate(world.obstacles):
        inside(f"obstacles[{i}]", obstacle.x, obstacle.y)
    names = [cluster.name for cluster in world.clusters]
    for i, name in enumerate(names):
        if name in names[:i]:
            raise InputError(where, f"clusters[{i}].name", repr(name), "a name that no other cluster has")
    footprints = Scene.from_world(world).footprints()
    gap, nearest_obstacle = nearest_footprint(footprints, world.start.x, world.start.y)
    if gap < HULL_RADIUS_M:
        raise InputError(where, "start", f"{max(gap, 0.0):.2f} m from obstacles[{nearest_obstacle}]",
                         f"at least {HULL_RADIUS_M} m of clearance for the hull")
    for i in unreachable_clusters(world):
        raise InputError(where, f"clusters[{i}]", f"{names[i]!r} out of reach",
                         f"a passage for a robot of {HULL_RADIUS_M} m radius from the start")


def _input_error(where: str, error: ValidationError) -> InputError:
    """The first fault that pydantic found, as one line."""
    first = error.errors()[0]
    field = ""
    for part in first["loc"]:
        field += f"[{part}]" if isinstance(part, int) else f"{'.' if field else ''}{part}"
    if first["type"] == "extra_forbidden":
        known = sorted({name for part in (ReefWorld, Cluster, Oyster, Obstacle, Start, Current, Seabed)
                        for name in part.model_fields})
        return InputError(where, field, "an unknown key", f"a known one{nearest(str(first['loc'][-1]), known)}")
    if first["type"] == "missing":
        return InputError(where, field, "nothing", "a value for this required key")
    found = repr(first["input"])
    expected = first["msg"].removeprefix("Value error, ").replace("Input should be ", "")
    return InputError(where, field, found if len(found) < 80 else found[:77] + "...", expected)


def _rounded(value: Any) -> Any:
    """Floats to a thousandth, in nested containers."""
    if isinstance(value, float):
        return round(value, 3) + 0.0
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    return [_rounded(item) for item in value] if isinstance(value, list | tuple) else value


def _flow(value: Any) -> str:
    return yaml.safe_dump(value, default_flow_style=True, sort_keys=False, width=10_000).removesuffix("...\n").strip()

"""`coral reef generate`: a new reef from a topology or a drawn polyline."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

from coral.errors import InputError
from coral.file_writer import writing
from coral.flags import Option
from coral.foreign_file import parse_json
from coral.plugins import our_part
from coral.reef.generator.generate import GeneratorCfg, command_line, generate
from coral.reef.world.world import save_world
from coral.words import many


@dataclass(frozen=True, kw_only=True)
class ReefGenerate:
    """Generate a new reef world; every cluster is proved reachable."""

    out: Path
    """World file to write; it must not exist."""
    polyline: str = ""
    """Spine of the reef instead of a topology, as JSON in metres: [[3,3],[12,4],[15,12]]."""
    json: bool = False
    """Print one JSON object."""
    preview: Path | None = None
    """Also draw it as a PNG."""
    cfg: Annotated[GeneratorCfg, Option(name="")] = field(default_factory=GeneratorCfg)
    """Properties of the reef."""

    def __call__(self) -> Mapping[str, Any]:
        cfg = self.cfg
        if self.polyline:
            cfg = replace(cfg, spine=(_points(self.polyline),))
        world = generate(cfg, self.out.stem)
        if self.out.exists():
            raise InputError("--out", str(self.out), "a file that exists", "a new file")
        if self.preview is not None:
            preview = our_part("preview", "one", "--preview")
            with writing("--preview", str(self.preview)):
                preview(world, self.preview)
        with writing("--out", str(self.out)):
            self.out.parent.mkdir(parents=True, exist_ok=True)
            save_world(world, self.out, f"Made by: {command_line(cfg, self.out.name)}")
        return {"world": str(self.out), "clusters": len(world.clusters), "obstacles": len(world.obstacles)}

    def describe(self, result: Mapping[str, Any]) -> str:
        return (
            f"{result['world']}: {many(result['clusters'], 'cluster')}, {many(result['obstacles'], 'obstacle')}; "
            f"run it with: coral reef run {result['world']}"
        )


def _points(text: str) -> tuple[tuple[float, float], ...]:
    try:
        return tuple((float(x), float(y)) for x, y in parse_json(text))
    except (ValueError, TypeError):
        raise InputError("--polyline", "", repr(text), "JSON like [[3,3],[12,4],[15,12]]") from None

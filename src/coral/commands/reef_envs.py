"""`coral reef envs`: list and preview the available reefs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from coral.disk_cache import code_stamp, recall
from coral.file_writer import writing
from coral.flags import Argument
from coral.plugins import our_part
from coral.reef.world.world_names import shipped_worlds

if TYPE_CHECKING:
    from coral.reef.world.world_model import ReefWorld


@dataclass(frozen=True, kw_only=True)
class ReefEnvs:
    """List the shipped reefs, or check and describe the given world files; draw previews on request."""

    worlds: Annotated[tuple[str, ...], Argument(metavar="[WORLD ...]", names=shipped_worlds)] = ()
    """Names or world files; all shipped reefs by default. generated: the forty generated ones, or gen:0-9 some."""
    preview: Path | None = None
    """Draw one PNG for each world into this folder, and sheet.png with all of them."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        names = self.worlds or tuple(shipped_worlds())
        if self.preview is None and set(names) <= set(shipped_worlds()):
            rows = recall("reefs", f"{names} {code_stamp()}", lambda: [_row(world) for world in _found(names)])
            return {"worlds": rows}
        worlds = _found(names)
        result: dict[str, Any] = {"worlds": [_row(world) for world in worlds]}
        if self.preview is not None:
            from coral.runs import file_stem

            preview, preview_sheet = (our_part("preview", part, "--preview") for part in ("one", "sheet"))
            columns = min(8 if len(worlds) > 20 else 5, len(worlds))
            with writing("--preview", str(self.preview), "a folder that can be written"):
                self.preview.mkdir(parents=True, exist_ok=True)
                result["previews"] = [str(preview(w, self.preview / f"{file_stem(w.name)}.png")) for w in worlds]
                result["sheet"] = str(preview_sheet(worlds, self.preview / "sheet.png", columns=columns))
        return result

    def describe(self, result: Mapping[str, Any]) -> str:
        lines = ["name   topology  size (m)   clusters  oysters  obstacles  current (m/s)"]
        for w in result["worlds"]:
            size = f"{w['size_m'][0]:g} x {w['size_m'][1]:g}"
            lines.append(
                f"{w['name']:<6} {w['topology']:<9} {size:<10} {w['clusters']:>8}  {w['oysters']:>7}  "
                f"{w['obstacles']:>9}  {w['current_m_s']:>13.2f}"
            )
        lines += [f"{w['name']}: {note}" for w in result["worlds"] for note in w["notes"]]
        if "sheet" in result:
            lines.append(f"previews: {result['sheet']}")
        return "\n".join(lines)


def _found(names: Sequence[str]) -> list[ReefWorld]:
    from coral.reef.world.find_world import expand_names, find_world

    return [find_world(name) for name in expand_names(names)]


def _row(world: ReefWorld) -> dict[str, Any]:
    from coral.reef.map.recognisable import unrecognisable

    return {
        "name": world.name,
        "topology": world.topology,
        "size_m": list(world.size_m),
        "clusters": len(world.clusters),
        "oysters": sum(len(cluster.oysters) for cluster in world.clusters),
        "obstacles": len(world.obstacles) + len(world.walls),
        "current_m_s": round((world.current.x_m_s**2 + world.current.y_m_s**2) ** 0.5, 3),
        "seed": world.seed,
        "notes": unrecognisable(world),
    }

"""`coral config`: the keys of a configuration, or one of them explained."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from coral.commands.departures import departs, rows_without_key
from coral.commands.unread_settings import refused_by
from coral.configurations import CONFIGURATIONS
from coral.errors import InputError, nearest
from coral.flags import Argument, Flag, shown
from coral.help_page import first_sentence
from coral.surface import described, load

WIDTH = 120
UNITS = {
    "m": "m", "mm": "mm", "m2": "m²", "s": "s", "ms": "ms", "1_s": "1/s", "m_s": "m/s", "m_s2": "m/s²",
    "deg": "deg", "deg_s": "deg/s", "rad": "rad", "rad_s": "rad/s", "hz": "Hz",
    "kg": "kg", "kg_m2": "kg m²", "n": "N", "n_m": "N m", "usd": "USD",
}  # fmt: skip
"""Unit by the end of a key; the n_m of a stiffness are N/m."""
_PARTS = {part for end in UNITS for part in end.split("_")}
HELP = f"{'; '.join(f'{name}, {what}' for name, (_, _, what) in CONFIGURATIONS.items())}."


@dataclass(frozen=True, kw_only=True)
class ListConfig:
    """List the keys of a configuration with their values, or explain one key or group of keys."""

    of: Annotated[str, Argument(metavar="CONFIGURATION", names=CONFIGURATIONS, help=HELP)]
    key: Annotated[str, Argument(metavar="[KEY]")] = ""
    """A key, such as pilot.trigger.stuck_s, or a group of keys, such as pilot.trigger."""
    departures: bool = False
    """What departs from the paper, with the reason: keys by their default, groups of keys, and code without a key."""
    config: Path | None = None
    """Show the values of this YAML file where it has some, such as the config.yaml of a run."""
    variant: str | None = None
    """Show the values of a variant of the survey (reef only)."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        if self.of not in CONFIGURATIONS:
            known = f"one of {', '.join(CONFIGURATIONS)}{nearest(self.of, CONFIGURATIONS)}"
            raise InputError("coral config", "", repr(self.of), known)
        place, flag, _ = CONFIGURATIONS[self.of]
        about = described(place)
        values = self._values(place)
        asked = re.sub(rf"^({flag}|{flag[2:]})\.", "", self.key).replace("-", "_").strip(".")
        chosen = [each for each in about.flags if f"{'.'.join(each.field)}.".startswith(f"{asked}." if asked else "")]
        chosen = [each for each in chosen if not self.departures or departs(each.text)]
        more = rows_without_key(self.of, place, asked) if self.departures else []
        if not chosen and not more:
            keys = [".".join(each.field[:n]) for each in about.flags for n in range(1, len(each.field) + 1)]
            raise InputError(f"coral config {self.of}", "", repr(self.key), f"one of its keys{_near(asked, keys)}")
        groups = {group.prefix.removeprefix("--").replace("-", "_"): group.text for group in about.groups}
        return {
            "configuration": self.of,
            "key": asked,
            "text": groups.get(asked, about.text) if len(chosen) > 1 else about.text,
            "keys": [*(_row(self.of, each, flag, values) for each in chosen), *more],
        }

    def _values(self, place: str) -> Any:
        """Return the configuration of the file and the variant; None for the default."""
        if self.config is None and self.variant is None:
            return None
        from coral.config import read_config

        values = load(place)()
        if self.config is not None:
            values = read_config(self.config, values)
        if self.variant is not None:
            if self.of != "reef":
                raise InputError("--variant", "", self.of, "reef, the only one with variants of its configuration")
            values = load("coral.reef.mission.variants:apply_variant")(self.variant, values)
        return values

    def describe(self, result: Mapping[str, Any]) -> str:
        rows = result["keys"]
        if self.departures:
            shown = (f" = {_amount(row)}" if row["flag"] else "" for row in rows)
            return "\n".join(
                textwrap.fill(f"{row['key']}{amount}: {row['text']}", WIDTH, subsequent_indent="  ")
                for row, amount in zip(rows, shown, strict=True)
            )
        if len(rows) == 1 and rows[0]["key"] == result["key"]:
            return _explained(rows[0])
        keys = max(len(row["key"]) for row in rows) + 2
        lines = [f"{row['key']:<{keys}}{_amount(row):<14} {first_sentence(row['text'])}".rstrip() for row in rows]
        lines = [line if len(line) <= WIDTH else f"{line[: WIDTH - 1].rstrip()}…" for line in lines]
        flag = CONFIGURATIONS[result["configuration"]][1]
        ends = f"Set one by {flag}.KEY VALUE; explain one by: coral config {result['configuration']} KEY"
        return "\n".join([textwrap.fill(result["text"], WIDTH), "", *lines, "", ends])


def _near(asked: str, keys: list[str]) -> str:
    """Suggest the nearest key; its last part alone is looked for too."""
    whole = {key.rpartition(".")[2]: key for key in keys} | {key: key for key in keys}
    return re.sub(r"'(.+)'", lambda match: repr(whole[match[1]]), nearest(asked, whole))


def _row(of: str, flag: Flag, prefix: str, values: Any) -> dict[str, Any]:
    key = ".".join(flag.field)
    for name in flag.field if values is not None else ():
        values = getattr(values, name)
    return {
        "key": key,
        "default": flag.default,
        "value": flag.default if values is None else shown(values),
        "unit": _unit(flag.field[-1]) if "number" in flag.type else "",
        "accepted": flag.type,
        "text": flag.text,
        "refused_by": [f"coral {command}" for command in refused_by(key) if command.startswith(f"{of} ")],
        "flag": f"{prefix}.{flag.name.removeprefix('--')}",
    }


def _unit(name: str) -> str:
    """Return the unit that the end of a key names, or ""."""
    parts = name.split("_")
    while parts and not all(part in _PARTS for part in parts):
        parts.pop(0)
    unit = UNITS.get("_".join(parts), "")
    return "N/m" if unit == "N m" and "stiffness" in name else unit


def _amount(row: Mapping[str, Any]) -> str:
    """Format the value with its unit, and mark one that is not the default."""
    mark = "" if row["value"] == row["default"] else " *"
    return f"{row['value'] or '-'} {row['unit']}".strip() + mark


def _explained(row: Mapping[str, Any]) -> str:
    lines = [f"{row['key']} = {_amount(row)}"]
    if row["text"]:
        lines.append(textwrap.fill(row["text"], WIDTH, initial_indent="  ", subsequent_indent="  "))
    lines.append(f"  accepted: {row['accepted']}")
    lines += [f"  default: {row['default']}"] if row["value"] != row["default"] else []
    if row["refused_by"]:
        lines.append(f"  not read, and refused, by: {', '.join(row['refused_by'])}")
    return "\n".join([*lines, f"  set by: {row['flag']} {'' if row['accepted'] == 'yes or no' else 'VALUE'}".rstrip()])

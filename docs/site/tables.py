"""Tables of the reference, made from the code. A page names one in a line of its own: `<!-- table: limits -->`.

Usage: python docs/site/tables.py NAME    (prints a table; without a name, the names)
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import is_dataclass
from functools import partial
from itertools import groupby, pairwise
from pkgutil import resolve_name
from types import ModuleType
from typing import Any, get_args

from cost_tables import tables as cost_tables

from coral import limits
from coral.advisor.registry import ENTRIES
from coral.advisor.setting import Mistake
from coral.campaign.campaign_files import CampaignFiles
from coral.cli import COMMANDS
from coral.commands.config import ListConfig
from coral.configurations import CONFIGURATIONS
from coral.contact.episode.recorder import columns_told
from coral.contact.memory.memory import Experience
from coral.contact.mistakes.plausible import CONTACT_MISTAKES
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.scene.conditions import Condition
from coral.contact.scene.task import Task
from coral.contact.scene.task_file import load_task_file
from coral.contact.scene.task_names import UNSEEN_HALVES, unseen_tasks
from coral.field_docs import class_doc, field_docs
from coral.reef.decide.mistakes import REEF_MISTAKES
from coral.reef.mission.presets import PRESETS
from coral.reef.mission.variants import VARIANTS
from coral.reef.products.product_files import ProductFiles
from coral.reef.recordings import bag_export as reef_bag
from coral.reef.ros import topics as ros_topics
from coral.reef.sea.recorded_camera import CameraFileCfg
from coral.reef.sea.survey_file import SurveyFile
from coral.reef.simulation.faults import FAULTS as SENSOR_FAULTS
from coral.reef.vehicle.sensing import Attitude, VehicleObservation
from coral.reef.vehicle.states import CHANGES
from coral.reef.world.geometry import Frame
from coral.reef.world.instruction import Clause
from coral.reef.world.kinds import catalogue
from coral.reef.world.world_model import ReefWorld
from coral.run_files import SurveyFiles, TaskFiles
from coral.surface import described
from coral.view.contact import bag_export as contact_bag

MARK = re.compile(r"^<!-- table: ([\w-]+) -->$", re.MULTILINE)
Rows = Iterable[Iterable[object]]


def fill(page: str) -> str:
    """Put the tables into a page that names them."""
    return MARK.sub(lambda match: TABLES[match[1]](), page)


def _table(head: str, rows: Rows) -> str:
    titles = [title.strip() for title in head.split("|")]
    lines = [" | ".join(" ".join(str(cell).split()).replace("|", "\\|") for cell in row) for row in rows]
    return "\n".join([f"| {' | '.join(titles)} |", "|" + "---|" * len(titles), *(f"| {line} |" for line in lines)])


def _commands() -> str:
    parts = []
    for name, (place, _) in COMMANDS.items():
        command = described(place)
        words = " ".join(flag.name for flag in command.flags if flag.positional)
        rows = [
            (f"`{flag.name}`", f"`{flag.default}`" if flag.default else "", flag.text)
            for flag in command.flags
            if "." not in flag.name
        ]
        text = " ".join(command.text.split())
        parts.append(f"## coral {name}\n\n`coral {name} {words}`. {text}\n\n{_table('flag | default | what', rows)}")
    return "\n\n".join(parts)


def _settings(of: str) -> str:
    parts = []
    for group, rows in groupby(ListConfig(of=of)()["keys"], lambda row: row["key"].rpartition(".")[0]):
        cells = (
            (f"`{row['key'].rpartition('.')[2]}`", f"{row['default'] or '–'} {row['unit']}", row["text"])
            for row in rows
        )
        parts.append(f"**{group or of}**\n\n" + _table("key | default | what", cells))
    return "\n\n".join(parts)


def _named(head: str, rows: Mapping[str, str]) -> str:
    return _table(head, ((f"`{name}`", text) for name, text in rows.items()))


def _files(kind: type) -> str:
    return _named("file | what", {getattr(kind, name): text for name, text in field_docs(kind).items()})


def _topics(bag: ModuleType) -> str:
    return _table(
        "topic | type | what", ((f"`{name}`", kind.split("/")[-1], bag.WHAT[name]) for name, kind in bag.TOPICS.items())
    )


def _unseen() -> str:
    rows = ((f"`{name}`", half, load_task_file(name).title) for half in UNSEEN_HALVES for name in unseen_tasks(half))
    return _table("task | half | what", rows)


def _kinds() -> str:
    rows = ((f"`{name}`", kind.class_, kind.says) for name, kind in catalogue().kinds.items())
    return _table("kind | class | what", rows)


def _limits() -> str:
    body = ast.parse(inspect.getsource(limits)).body
    return _table(
        "limit | value | of what, and why",
        (
            (f"`{one.targets[0].id}`", f"{getattr(limits, one.targets[0].id):,.0f}", below.value.value)
            for one, below in pairwise(body)
            if isinstance(one, ast.Assign)
            and isinstance(one.targets[0], ast.Name)
            and isinstance(below, ast.Expr)
            and isinstance(below.value, ast.Constant)
        ),
    )


def _states() -> str:
    return _table(
        "from | to | who | cause | when",
        (
            (row.source, row.target, row.who, row.cause, row.means + (" *Only its own hold.*" if row.after else ""))
            for row in CHANGES
        ),
    )


def _mistakes(mistakes: Iterable[Mistake]) -> str:
    def linked(text: str) -> str:
        return re.sub(r"arXiv:([\d.]+\d)", r"[arXiv:\1](https://arxiv.org/abs/\1)", text)

    rows = ((f"`{one.name}`", one.what, linked(one.found_in) or "–") for one in mistakes)
    return _table("error | what goes wrong | where models were found to make it", rows)


def _presets() -> str:
    return _table(
        "preset | key | value | why",
        (
            (f"`{preset.name}`", f"`{condition.key}`", f"{condition.value:g}", condition.reason)
            for preset in PRESETS.values()
            for condition in preset.conditions
        ),
    )


def _plain(default: object) -> str:
    """Return a default as it would stand in a file; nothing where it says nothing."""
    values = default if isinstance(default, tuple) else (default,)
    plain = default not in ((), "") and all(isinstance(value, str | int | float) for value in values)
    return f"`{list(values) if isinstance(default, tuple) else default}`" if plain else ""


def _conditions(union: object) -> str:
    def keys(kind: type) -> str:
        fields = {key: field for key, field in kind.model_fields.items() if key not in ("kind", "object")}  # type: ignore[attr-defined]
        return ", ".join(
            f"`{key}`" + ("" if field.is_required() or not _plain(field.default) else f" ({field.default})")
            for key, field in fields.items()
        )

    kinds = sorted(get_args(get_args(union)[0]), key=lambda kind: kind.model_fields["kind"].default)
    return _table(
        "kind | holds when | keys (default)",
        ((f"`{kind.model_fields['kind'].default}`", class_doc(kind), keys(kind)) for kind in kinds),
    )


def _keys(place: str, kind: Any, *, nested: bool = True) -> str:
    """Return the keys of a file, then those of its parts. Keys without a text share that of the next one."""
    parts, seen, tables = [(place, kind)], [kind], []
    for place, kind in parts:  # grows
        listed = inspect.getdoc(kind).partition("Args:")[2]
        docs = dict(re.findall(r"^    (\w+): (.*?)(?=^    \w+: |\Z)", listed, re.M | re.S)) | field_docs(kind)
        rows: list[tuple[str, str, str]] = []
        names, defaults = [], []
        for name, field in (kind.__dataclass_fields__ if is_dataclass(kind) else kind.model_fields).items():
            needed = field.default is field.default_factory if is_dataclass(kind) else field.is_required()
            names.append(f"`{name}`")
            defaults.append("required" if needed else _plain(field.default))
            if name in docs:
                rows.append((", ".join(names), ", ".join(dict.fromkeys(filter(None, defaults))), docs[name]))
                names, defaults = [], []
            if nested and name != "conditions":  # they have a table of their own
                found = [one for one in _models(getattr(field, "annotation", None)) if one not in seen]
                parts += [(name, one) for one in found]
                seen += found
        rows += [(name, "", "") for name in names]
        tables.append(f"**`{place}`**: {class_doc(kind)}\n\n{_table('key | default | what', rows)}")
    return "\n\n".join(tables)


def _models(annotation: Any) -> Iterator[type]:
    """Find the models in an annotation."""
    if hasattr(annotation, "model_fields"):
        yield annotation
    for inner in get_args(annotation):
        yield from _models(inner)


NAMED = {
    "events-survey": ("event | what, and its keys", "coral.reef.mission.events:EVENTS"),
    "events-task": ("event | what, and its keys", "coral.contact.episode.events:EVENTS"),
    "columns-survey": ("columns | what", "coral.reef.mission.record:TRAJECTORY"),
    "attempts": ("keys | what", "coral.advisor.log:KEYS"),
    "timing": ("key | what", "coral.run_loop:TIMING"),
    "metrics-survey": ("key | what", "coral.reef.mission.metrics:DEFINITIONS"),
    "metrics-task": ("key | what", "coral.contact.episode.metrics:DEFINITIONS"),
    "variants-task": ("variant | what", "coral.contact.episode.variants:WHAT"),
    "sweeps": ("key | what it changes", "coral.reef.mission.sweep:WHAT"),
    "ends-survey": ("reason | what", "coral.reef.mission.end_reasons:END_REASONS"),
    "codes-policy": ("code | what", "coral.contact.policy.client:CODES"),
    "ends-task": ("reason | what", "coral.contact.episode.end_reasons:END_REASONS"),
    "entry-points": ("group | the entry point is a", "coral.plugins:GROUPS"),
    "columns-clusters": ("columns | what", "coral.reef.products.product_files:CLUSTERS"),
    "columns-shells": ("columns | what", "coral.reef.products.product_files:SHELLS"),
    "columns-density": ("columns | what", "coral.reef.products.product_files:DENSITY"),
    "products": ("keys | what", "coral.reef.products.product_files:NUMBERS"),
    "question": ("keys | what", "coral.advisor.desk:KEYS"),
    "codes-advisor": ("code | what", "coral.advisor.codes:CODES"),
    "codes-survey": ("code | what", "coral.reef.decide.codes:CODES"),
    "codes-task": ("code | what", "coral.contact.plan.codes:CODES"),
}
"""Tables of a mapping: head, and where it is."""
TABLES: dict[str, Callable[[], str]] = {
    "commands": _commands,
    **{f"settings-{name}": partial(_settings, name) for name in CONFIGURATIONS},
    **{name: partial(_named, head, resolve_name(place)) for name, (head, place) in NAMED.items()},
    "columns-task": partial(_named, "columns | what", columns_told()),
    "variants-survey": partial(_named, "variant | what", {name: inspect.getdoc(of) for name, of in VARIANTS.items()}),
    "sensor-faults": partial(_named, "fault | what", {name: kind.means for name, kind in SENSOR_FAULTS.items()}),
    "advisors": partial(_named, "advisor | who", {entry.form: entry.what for entry in ENTRIES}),
    "files-survey": partial(_files, SurveyFiles),
    "files-task": partial(_files, TaskFiles),
    "files-bench": partial(_files, CampaignFiles),
    "files-products": partial(_files, ProductFiles),
    "task-file": partial(_keys, "task", Task),
    "cost-file": partial(_keys, "cost", PlanAnswer),
    "world-file": partial(_keys, "world", ReefWorld),
    "survey-file": partial(_keys, "survey", SurveyFile),
    "camera-file": partial(_keys, "camera", CameraFileCfg),
    "observation": partial(_keys, "VehicleObservation", VehicleObservation),
    "observation-frame": partial(_keys, "frame", Frame),
    "observation-attitude": partial(_keys, "attitude", Attitude),
    "memory-file": partial(_keys, "experiences", Experience, nested=False),
    "conditions": partial(_conditions, Condition),
    "clauses": partial(_conditions, Clause),
    "topics-survey": partial(_topics, reef_bag),
    "topics-ros2": partial(_topics, ros_topics),
    "topics-task": partial(_topics, contact_bag),
    "mistakes-survey": partial(_mistakes, REEF_MISTAKES),
    "mistakes-task": partial(_mistakes, CONTACT_MISTAKES),
    "unseen": _unseen,
    "kinds": _kinds,
    "presets": _presets,
    "states": _states,
    "limits": _limits,
    **{f"cost-{name}": partial(str, text.rstrip()) for name, text in cost_tables().items()},
}


if __name__ == "__main__":
    print(TABLES[sys.argv[1]]() if len(sys.argv) == 2 else "\n".join(TABLES))

"""Tables of the reference, made from the code. A page has, in the place of a table, the command that prints it.

Usage: python docs/site/tables.py NAME    (prints a table; without a name, the names)
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from functools import partial
from pkgutil import resolve_name

import table_makers as make
from cost_tables import tables as cost_tables
from reference_texts import VEHICLE_TOPICS

from coral.advisor.registry import ENTRIES
from coral.campaign.store import CampaignFiles
from coral.contact.episode.recorder import columns_told
from coral.contact.episode.trial_log import END_REASONS
from coral.contact.franka.world import CODES as STOP_CODES
from coral.contact.memory.memory import Experience
from coral.contact.mistakes.plausible import CONTACT_MISTAKES
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.real_scenes.cameras.rgbd_camera import CAMERAS
from coral.contact.real_scenes.masks.mask_source import MASKS
from coral.contact.scene.conditions import Condition
from coral.contact.scene.task import Task
from coral.exit_code import ExitCode
from coral.plugins import OURS
from coral.reef.decide.mistakes import REEF_MISTAKES
from coral.reef.mission.variants import VARIANTS
from coral.reef.paint.labelled_pictures import LabelFiles
from coral.reef.products.product_files import ProductFiles
from coral.reef.recordings import bag_export as reef_bag
from coral.reef.sea.recorded_camera import CameraFileCfg
from coral.reef.sea.survey_file import SurveyFile
from coral.reef.vehicle.sensing import Attitude, VehicleObservation
from coral.reef.world.geometry import Frame
from coral.reef.world.instruction import Clause
from coral.reef.world.world_model import ReefWorld
from coral.run_files import SurveyFiles, TaskFiles
from coral.surface import CONFIGURATIONS

MARK = re.compile(r"^`\.venv/bin/python docs/site/tables\.py ([\w-]+)` prints this table\.$", re.MULTILINE)


def fill(page: str) -> str:
    """Put the tables into a page that names them."""
    return MARK.sub(lambda match: TABLES[match[1]](), page)


EXPORTERS = {name: resolve_name(place) for name, place in OURS["coral.exporters"].items()}
NAMED = {
    "events-survey": ("event | what, and its keys", "reference_texts:SURVEY_EVENTS"),
    "events-task": ("event | what, and its keys", "reference_texts:TASK_EVENTS"),
    "columns-survey": ("columns | what", "coral.reef.mission.record:TRAJECTORY"),
    "attempts": ("keys | what", "reference_texts:ATTEMPT_KEYS"),
    "timing": ("key | what", "reference_texts:TIMING"),
    "metrics-survey": ("key | what", "coral.reef.mission.metrics:DEFINITIONS"),
    "metrics-task": ("key | what", "coral.contact.episode.metrics:DEFINITIONS"),
    "variants-task": ("variant | what", "coral.contact.episode.variants:VARIANTS"),
    "ends-survey": ("reason | what", "reference_texts:SURVEY_ENDS"),
    "codes-policy": ("code | what", "reference_texts:POLICY_CODES"),
    "ends-task": ("reason | what", "coral.contact.episode.trial_log:END_REASONS"),
    "entry-points": ("group | the entry point is a", "coral.plugins:GROUPS"),
    "columns-clusters": ("columns | what", "coral.reef.products.product_files:CLUSTERS"),
    "columns-shells": ("columns | what", "coral.reef.products.product_files:SHELLS"),
    "columns-density": ("columns | what", "coral.reef.products.product_files:DENSITY"),
    "products": ("keys | what", "reference_texts:PRODUCTS"),
    "question": ("keys | what", "reference_texts:QUESTION_KEYS"),
    "codes-advisor": ("code | what", "reference_texts:ADVISOR_CODES"),
    "codes-survey": ("code | what", "reference_texts:SURVEY_CODES"),
    "codes-task": ("code | what", "reference_texts:TASK_CODES"),
    "diagnoses": ("diagnosis | what", "coral.contact.thinker.diagnosis:TEXTS"),
    "libero": ("kind | what", "coral.contact.libero.package:SUITES"),
    "addresses": ("address | what", "coral.reef.sea.transport:FORMS"),
    "policy-observation": ("key | what", "coral.contact.policy.libero_convention:OBSERVATION"),
}
"""Tables of a mapping: head, and where it is."""
TABLES: dict[str, Callable[[], str]] = {
    "commands": make.commands,
    **{f"settings-{name}": partial(make.settings, name) for name in CONFIGURATIONS},
    **{name: partial(make.named, head, resolve_name(place)) for name, (head, place) in NAMED.items()},
    "columns-task": partial(make.named, "columns | what", columns_told()),
    "variants-survey": partial(
        make.named, "variant | what", {name: variant.what for name, variant in VARIANTS.items()}
    ),
    "advisors": partial(make.named, "advisor | who", {entry.form: entry.what for entry in ENTRIES}),
    "files-survey": partial(make.files, SurveyFiles),
    "files-task": partial(make.files, TaskFiles),
    "files-bench": partial(make.files, CampaignFiles),
    "files-products": partial(make.files, ProductFiles),
    "files-labelled": partial(make.files, LabelFiles),
    "exit-codes": partial(make.files, ExitCode, "code | what"),
    "cameras": partial(make.named, "`--camera` | what", CAMERAS),
    "masks": partial(make.named, "`--masks` | what", MASKS),
    "ends-arm": partial(make.named, "end reason | why", {end: END_REASONS[end] for end in STOP_CODES.values()}),
    "exporters": partial(
        make.first_paragraphs,
        "`coral export RUN --to` | what",
        EXPORTERS,
    ),
    "flag-fallback": partial(make.flag_texts, "--fallback"),
    "settings-arm": partial(make.settings, "contact", "franka"),
    "settings-policy": partial(make.settings, "contact", "policy.libero"),
    "departures-reef": partial(make.departures, "reef"),
    "operator": make.operator,
    "waters": make.waters,
    "layouts": make.layouts,
    "task-file": partial(make.keys, "task", Task),
    "cost-file": partial(make.keys, "cost", PlanAnswer),
    "world-file": partial(make.keys, "world", ReefWorld),
    "survey-file": partial(make.keys, "survey", SurveyFile),
    "camera-file": partial(make.keys, "camera", CameraFileCfg),
    "observation": partial(make.keys, "VehicleObservation", VehicleObservation),
    "observation-frame": partial(make.keys, "frame", Frame),
    "observation-attitude": partial(make.keys, "attitude", Attitude),
    "memory-file": partial(make.keys, "experiences", Experience, nested=False),
    "conditions": partial(make.conditions, Condition),
    "clauses": partial(make.conditions, Clause),
    "topics-survey": partial(make.topics, reef_bag.TOPICS),
    "topics-ros2": partial(make.topics, VEHICLE_TOPICS),
    "mistakes-survey": partial(make.mistakes, REEF_MISTAKES),
    "mistakes-task": partial(make.mistakes, CONTACT_MISTAKES),
    "unseen": partial(make.suite, "unseen"),
    "long": partial(make.suite, "long"),
    "kinds": make.kinds,
    "presets": make.presets,
    "states": make.states,
    "limits": make.size_limits,
    **{f"cost-{name}": partial(str, text.rstrip()) for name, text in cost_tables().items()},
}


def asked(words: list[str]) -> str:
    """Return the table of this name, or all names.

    Raises:
        SystemExit: There is no such table.
    """
    if not words:
        return "\n".join(TABLES)
    if len(words) > 1 or words[0] not in TABLES:
        raise SystemExit(f"tables.py: {' '.join(words)}: no such table; without a name, it lists them")
    return TABLES[words[0]]()


if __name__ == "__main__":
    print(asked(sys.argv[1:]))

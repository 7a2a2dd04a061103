"""Parts by name: those of the wings of this package, and those that other installed packages offer by entry points.

The spine imports no wing. Where it has a place for one, the wing's part is named in `OURS` and imported when it is
asked for, as an entry point of another package is.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from coral.errors import InputError, first_line, nearest

GROUPS = {
    "coral.advisors": "function (name, rest, Setting) that makes an advisor; NAME[:ARGUMENT] after --advisor",
    "coral.controllers": "function of a ControllerSetup that makes a controller of the vehicle; NAME after "
    "--cfg.driver",
    "coral.triggers": "function of a TriggerMoment that returns whether to ask now; NAME after --trigger",
    "coral.verifiers": "function (question, answer) that returns why an answer is refused, or None; NAME after "
    "--verifier",
    "coral.costs": "function of a Task that makes a cost, a Stage, several stages or a Strategy; NAME after --cost",
    "coral.hand_controllers": "function (planning world, configuration, generator) that makes a hand's controller; "
    "controller= in Python",
    "coral.cameras": "function (rest, T_world_camera or None) that makes an RgbdCamera; NAME[:REST] after --camera",
    "coral.masks": "function (rest, trial, models of its objects by name) that makes a MaskSource; NAME[:REST] after "
    "--masks",
    "coral.conditions": "class of a condition of success, a subclass of BaseCondition; its `kind` in a task file",
    "coral.commands": "dataclass of a command, coral NAME; a dot in the name separates its two words",
    "coral.vehicles": "function of what follows NAME: after --vehicle that makes a VehicleLink",
    "coral.eyes": "function without arguments that makes an RgbPerception; NAME after --perception",
    "coral.exporters": "function (recording, path) that writes it and returns counts; NAME after --to",
    "coral.tasks": "function of NAME:REST that loads a contact task; coral contact run NAME:REST",
    "coral.worlds": "function (trial, control period in s) that makes an EvaluationWorld; NAME after --world",
    "coral.robots": "object with the functions of `RobotKind`; NAME after --world, its address after --robot",
}
"""What the entry points of each group are."""

OURS: dict[str, dict[str, str]] = {
    "coral.exporters": {
        "mcap": "coral.reef.recordings.bag_export:export_mcap",
        "bag": "coral.reef.recordings.bag_export:export_bag",
        "pictures": "coral.reef.recordings.picture_folder:export_pictures",
    },
    "coral.cameras": {
        "bag": "coral.contact.real_scenes.cameras.bag_camera:BagRgbdCamera",
        "realsense": "coral.contact.real_scenes.cameras.realsense_camera:RealSenseCamera",
        "drawn": "coral.contact.real_scenes.cameras.drawn_camera:still_camera",
    },
    "coral.masks": {"colour": "coral.contact.real_scenes.masks.colour_masks:make_colour_masks"},
    "coral.tasks": {"libero": "coral.contact.libero.task:load_libero"},
    "coral.worlds": {
        "panda": "coral.contact.worlds.panda.world:PandaWorld",
        "hand": "coral.contact.worlds.hand_world:HandWorld",
    },
    "coral.robots": {"franka": "coral.commands.franka_robot"},
    "coral.vehicles": {
        "mavlink": "coral.reef.sea.mavlink_link:MavlinkLink",
        "simulated": "coral.reef.rehearsal.simulated_link:SimulatedLink",
        "ros2": "coral.reef.ros.ros_link:RosLink",
    },
    "coral.advisors": {
        "desk": "coral.desk.advisor:make_desk",
        "sloppy": "coral.erring.sloppy:make_sloppy",
    },
    "ros2": {
        "camera": "coral.reef.ros.ros_camera:RosCamera",
        "sonar": "coral.reef.ros.ros_sonar:RosSonar",
        "topics": "coral.reef.ros.survey_topics:SurveyTopics",
    },
    "rehearsal": {
        "camera": "coral.reef.rehearsal.simulated_sensors:simulated_camera",
        "sonar": "coral.reef.rehearsal.simulated_sensors:simulated_sonar",
        "truth": "coral.reef.rehearsal.truth:follow_truth",
    },
    "networks": {
        "classes": "coral.reef.networks.own_network:open_classes",
        "depth": "coral.reef.networks.relative_depth:with_depth",
    },
    "mistakes": {
        "reef": "coral.reef.decide.mistakes:REEF_MISTAKES",
        "contact": "coral.contact.mistakes.plausible:CONTACT_MISTAKES",
    },
    "experts": {"cost": "coral.contact.experts:expert"},
    "generator": {
        "world": "coral.reef.generator.generated:make_world",
        "names": "coral.reef.generator.generated:expand_name",
    },
    "painter": {"reef": "coral.reef.paint.painter:Painter"},
    "policy": {"served": "coral.contact.policy.policy_campaign_episode:run_served_policy"},
    "notice": {"desk": "coral.desk.notice:mission_notice"},
    "rendering": {"run": "coral.view.rendering:render_run"},
    "plot": {
        "reef": "coral.view.plots:plot_survey",
        "contact": "coral.view.plots:plot_attempt",
        "page": "coral.view.plots:html_of",
    },
    "preview": {"one": "coral.view.preview:preview", "sheet": "coral.view.preview:preview_sheet"},
    "live": {"run": "coral.view.live.watching:watching_run"},
    "lens": {"check": "coral.reef.recordings.lens_check:check_run_lens"},
}
"""Parts of this package by group and name; groups that are not in `GROUPS` take none of other packages."""


def find_plugins(group: str) -> dict[str, EntryPoint]:
    """Find the parts of a group by name, ours first; nothing is imported."""
    ours = {name: EntryPoint(name, place, group) for name, place in OURS.get(group, {}).items()}
    return ours | {point.name: point for point in entry_points(group=group) if point.name not in ours}


def has_plugin(group: str, name: str) -> bool:
    """Return whether a group has a part of this name. Other packages are searched only if it is none of ours."""
    return name in OURS.get(group, {}) or name in find_plugins(group)


def load_plugin(point: EntryPoint, where: str) -> Any:
    """Import what an entry point names.

    Raises:
        InputError: It cannot be imported, or it belongs to a wing that is not installed.
    """
    try:
        return point.load()
    except (ImportError, AttributeError) as error:
        if point.value == OURS.get(point.group, {}).get(point.name):
            missing = str(getattr(error, "name", None))
            if not missing.startswith("coral."):
                raise
            raise InputError(where, "", repr(point.name), f"the wing {missing}, which is not installed") from None
        package = point.dist.name if point.dist is not None else "a package"
        found = f"{point.name!r} of {package}, which does not load ({first_line(error)})"
        raise InputError(where, "", found, point.value) from None


def our_part(group: str, name: str, where: str) -> Any:
    """Import a part of this package that may be in a wing.

    Raises:
        InputError: The wing is not installed; the error names the flag or argument `where`.
    """
    return load_plugin(EntryPoint(name, OURS[group][name], group), where)


def named_plugin(group: str, name: str, where: str, field: str = "", ours: Sequence[str] = ()) -> Any:
    """Import the part of this name.

    Raises:
        InputError: There is none of this name, or it cannot be imported.
    """
    if name in OURS.get(group, {}):
        return our_part(group, name, where)
    known = find_plugins(group)
    if name not in known:
        names = [*ours, *known]
        listed = f"one of {', '.join(names)}, or" if names else "the name of"
        expected = f"{listed} an entry point of the group {group}{nearest(name, names)}"
        raise InputError(where, field, repr(name), expected)
    return load_plugin(known[name], where)

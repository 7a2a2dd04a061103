"""Baselines and ablations as configurations of the one pipeline (paper IV-C, IV-D)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from coral.config import merge, nested
from coral.errors import InputError, nearest
from coral.reef.mission.mission_cfg import MissionCfg


@dataclass(frozen=True, kw_only=True)
class Variant:
    """A configuration of the pipeline."""

    what: str
    changes: Mapping[str, Any] = field(default_factory=dict)
    """Dotted keys of the configuration, and their values."""
    alone: bool = False
    """Whether whoever decides stands alone: no rules step in where its answers fail."""


UNCHECKED = {"planner.checks": False}
WITHOUT_DOTS = {"planner.centroid_selection": False}
PLANNED_BEFORE = WITHOUT_DOTS | {"planner.finished": False, "planner.route.ahead": False, "latency": "0"}
"""Waypoints that need only lie in open water within reach, from where the robot is: they do not depend on what has been
found."""
PD = {"driver": "pd", "simulator.contact": "ghost"}
PAPER = {
    "planner.algorithm": "paper",
    "planner.route.ahead": False,
    "belief.inspect.enabled": False,
    "pilot.trigger.cooldown_s": 50.0,  # T_cooldown (paper IV-F)
}
NEAREST = {"decider": "nearest", "latency": "0"}
NO_DDP = {"controller.uniform": True}
NO_COST_TO_GO = {"pilot.cost_to_go": False}
GLIDED = {"latency": "0", "stop_when_covered": False, "simulator.vehicle.model": "kinematic"}
"""A vehicle without inertia that follows a plan to its end."""

VARIANTS: dict[str, Variant] = {
    "full": Variant(
        what="What goes beyond the paper: a tour of all known clusters that weighs what each is worth, looks from near "
        "until a cluster is inspected, and questions that are asked ahead of need. Together they take the time to 90 % "
        "of the oysters [from 297 to 85 s](../research/inspection.md).",
    ),
    "paper": Variant(
        what="The paper's Alg. 2 in place of our planner. Its prompts (five points, priority rules), one goal at a "
        "time, asked for 2.5 m before the present one and measured from the robot, checked by Eqs. 4-8 at request and "
        "response; refusals that name only the failure mode; 1 m from the previous goal, 50 s between questions, a "
        "cluster visited within 3 m of its centre.",
        changes=PAPER,
    ),
    "pd": Variant(
        what='A PD controller drives; it passes through what it hits, and each contact is counted ("w/o low-level '
        "planner\"). The paper's PD still covers 91 %, so contacts cannot have stopped that vehicle. Against solid "
        "obstacles ours stays at the first one.",
        changes=PD,
    ),
    "dream": Variant(
        what="DREAM, the earlier system that the paper compares with, rebuilt from its description (IV-C, IV-E). One "
        "action of one second per answer, one answer every 5 s whatever `--cfg.latency` says, standing still in "
        "between; PD control, and obstacles stop it; no chain in its pictures, prompt or facts, only the green cells "
        "of the map; no check except that a point lies in the survey area. Its own actions and gains are not public: "
        "an action here is a second's drive towards the chosen waypoint.",
        changes=PD
        | UNCHECKED
        | WITHOUT_DOTS
        | {
            "simulator.contact": "solid",
            "planner.algorithm": "paper",
            "planner.route.ahead": False,
            "belief.centroids": False,
            "pilot.trigger.always": True,
            "pilot.trigger.cooldown_s": 0.0,
            "pilot.synchronous": True,
            "latency": "fixed:5",
        },
        alone=True,
    ),
    "rule-based": Variant(
        what="Always drives to the nearest unvisited cluster, or to the nearest unexplored water if none is known.",
        changes=NEAREST,
        alone=True,
    ),
    "rule-based-dots-only": Variant(
        what="The same rule in the `paper` variant, without exploring (`--cfg.planner.no-explore`). If no unvisited "
        "cluster is known, the robot stays where it is: the paper (IV-D) names the nearest unvisited centroid, and no "
        "rule for water where none is known yet.",
        changes=PAPER | NEAREST | {"planner.explore": False},
        alone=True,
    ),
    "frontier": Variant(
        what="Frontier exploration (Yamauchi 1997) that ignores oysters.",
        changes=PLANNED_BEFORE | {"decider": "frontier"},
        alone=True,
    ),
    "lawnmower": Variant(
        what="Parallel lanes over the whole area (`--cfg.lane-m`), planned before the dive, and driven by the same "
        "controller around what is on the map; in a mission in words also over dots, and back to the start.",
        changes={"decider": "lawnmower", "planner.route.ahead": False, "planner.instruction.clear_m": 0.0},
    ),
    "no-verification": Variant(
        what="Chosen points go to the controller without a check, into an obstacle if need be. Only points outside the "
        "survey area are refused. Violations are counted.",
        changes=UNCHECKED,
    ),
    "no-centroid-selection": Variant(
        what="The advisor sees the chain, but is asked only for free waypoints.", changes=WITHOUT_DOTS
    ),
    "no-trigger": Variant(
        what="The advisor is asked again after every cooldown.", changes={"pilot.trigger.always": True}
    ),
    "no-ddp": Variant(
        what="All rollout steps have the same fidelity: equal intervals, every boundary point at every step.",
        changes=NO_DDP,
    ),
    "no-cost-to-go": Variant(
        what="The controller is given the straight distance to its goal instead of the way around known obstacles. "
        "Only its rollouts, 3 m long, see what lies between.",
        changes=NO_COST_TO_GO,
    ),
    "no-cost-to-go-no-ddp": Variant(
        what="Both: what DDP is worth to a local planner alone.", changes=NO_COST_TO_GO | NO_DDP
    ),
    "no-topology": Variant(
        what="No tour of what is left is planned: the mode follows Alg. 2, and no choice is priced.",
        changes={"planner.topology": False},
    ),
    "random": Variant(
        what="The whole system, but the advisor draws lots among what is offered; it takes as long as the rules.",
        changes={"decider": "random"},
        alone=True,
    ),
    "random-unchecked": Variant(
        what="The same without verification: the robot drives wherever the draw says.",
        changes=UNCHECKED | {"decider": "random"},
        alone=True,
    ),
    "constant": Variant(
        what="The whole system, but the advisor always says the first dot, or straight ahead.",
        changes={"decider": "constant"},
        alone=True,
    ),
    "constant-unchecked": Variant(
        what="The same without verification.", changes=UNCHECKED | {"decider": "constant"}, alone=True
    ),
    "clairvoyant": Variant(
        what="The whole system with an advisor that knows, in truth, where the clusters are: what it is worth to know "
        "more than the map.",
        changes={"decider": "clairvoyant"},
        alone=True,
    ),
    "clairvoyant-unchecked": Variant(
        what="The same without verification: what a check does to whoever knows more.",
        changes=UNCHECKED | {"decider": "clairvoyant"},
        alone=True,
    ),
    "blind-sweep": Variant(
        what="Straight lanes 4 m apart (`--cfg.lane-m`) at cruise speed, without sensing. It passes through whatever "
        "is in the way; each contact is counted.",
        changes=GLIDED | {"decider": "sweep", "simulator.contact": "ghost"},
    ),
    "oracle": Variant(
        what="A short tour past everything, planned on the true reef: a bound, not a method. In a mission in words it "
        "knows the kinds.",
        changes=GLIDED | {"decider": "oracle"},
    ),
    "geometry": Variant(
        what="In a mission in words: rules that know its conditions, but not the kinds of things.",
        changes={"decider": "geometry"},
        alone=True,
    ),
    "keywords": Variant(
        what="In a mission in words: rules that read key words, and see no pictures.",
        changes={"decider": "keywords"},
        alone=True,
    ),
}


def apply_variant(name: str, cfg: MissionCfg) -> MissionCfg:
    """Return `cfg` with the changes of a named variant.

    Raises:
        InputError: There is no such variant.
    """
    if name not in VARIANTS:
        raise InputError("--variant", "", repr(name), f"one of {', '.join(VARIANTS)}{nearest(name, VARIANTS)}")
    variant = VARIANTS[name]
    alone = {"pilot.fallback": "hold"} if variant.alone and cfg.pilot.fallback == "rules" else {}
    return merge(cfg, nested({**variant.changes, **alone}, "--cfg"), "--cfg")

"""Baselines and ablations as configurations of the one pipeline (paper IV-C, IV-D)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from coral.advisor.fallback import Fallback
from coral.errors import InputError, nearest
from coral.reef.mission.mission_cfg import MissionCfg

PAPER_COOLDOWN_S = 50.0
"""T_cooldown (paper IV-F)."""
Change = Callable[[MissionCfg], MissionCfg]


def _no_verification(cfg: MissionCfg) -> MissionCfg:
    """Chosen points go to the controller unchecked, but for those outside the survey area; violations are counted."""
    return replace(cfg, planner=replace(cfg.planner, checks=False))


def _planned_before(cfg: MissionCfg) -> MissionCfg:
    """Chosen points need only lie in open water within reach: they do not depend on what has been found."""
    return replace(cfg, planner=replace(cfg.planner, provable=replace(cfg.planner.provable, finished=False)))


def _alone(cfg: MissionCfg) -> MissionCfg:
    """Whoever decides stands alone: no rules step in where its answers fail."""
    fallback: Fallback = "hold" if cfg.pilot.fallback == "rules" else cfg.pilot.fallback
    return replace(cfg, pilot=replace(cfg.pilot, fallback=fallback))


def _no_centroid_selection(cfg: MissionCfg) -> MissionCfg:
    """Show the chain, but ask only for free waypoints."""
    return replace(cfg, planner=replace(cfg.planner, centroid_selection=False))


def _no_topology(cfg: MissionCfg) -> MissionCfg:
    """Plan no tour of what is left: the mode follows Alg. 2, and no price is told."""
    return replace(cfg, planner=replace(cfg.planner, topology=replace(cfg.planner.topology, enabled=False)))


def _asked_near(cfg: MissionCfg) -> MissionCfg:
    """The next goal is asked for near the present one and measured from the robot."""
    return replace(cfg, planner=replace(cfg.planner, route=replace(cfg.planner.route, ahead=False)))


def _paper(cfg: MissionCfg) -> MissionCfg:
    """As the paper has it: Alg. 2 with its prompts and checks, a cooldown of 50 s, clusters visited by distance."""
    belief = replace(cfg.belief, inspect=replace(cfg.belief.inspect, enabled=False))
    trigger = replace(cfg.pilot.trigger, cooldown_s=PAPER_COOLDOWN_S)
    cfg = replace(cfg, belief=belief, pilot=replace(cfg.pilot, trigger=trigger))
    return _asked_near(replace(cfg, planner=replace(cfg.planner, algorithm="paper")))


def _no_trigger(cfg: MissionCfg) -> MissionCfg:
    """Ask the advisor again at every cooldown."""
    return replace(cfg, pilot=replace(cfg.pilot, trigger=replace(cfg.pilot.trigger, always=True)))


def _no_ddp(cfg: MissionCfg) -> MissionCfg:
    """Use uniform intervals and check every boundary point at every step."""
    return replace(cfg, controller=replace(cfg.controller, uniform=True))


def _no_cost_to_go(cfg: MissionCfg) -> MissionCfg:
    """Drive by the straight distance to the goal: only the rollouts see what lies between."""
    return replace(cfg, pilot=replace(cfg.pilot, cost_to_go=False))


def _no_cost_to_go_no_ddp(cfg: MissionCfg) -> MissionCfg:
    """Do without both: what DDP is worth where no cost-to-go leads around obstacles."""
    return _no_ddp(_no_cost_to_go(cfg))


def _pd(cfg: MissionCfg) -> MissionCfg:
    """Use a PD controller in place of DDP-MPPI ("w/o low-level planner").

    It passes through what it hits: the paper's PD still covers 91 %, so contacts cannot have stopped that vehicle.
    Against solid obstacles ours stays at the first one.
    """
    return replace(cfg, driver="pd", simulator=replace(cfg.simulator, contact="ghost"))


def _dream(cfg: MissionCfg) -> MissionCfg:
    """DREAM (paper IV-C, IV-E): one action of 1 s for each answer, standing still meanwhile; PD, no chain, no checks.

    No clusters are extracted, so that its pictures, prompt and facts hold none; only the map's green cells show where
    oysters are. Its own action set and gains are not public: an action here is a second's drive towards the chosen
    waypoint.
    """
    trigger = replace(cfg.pilot.trigger, always=True, cooldown_s=0.0)
    pilot = replace(cfg.pilot, trigger=trigger, synchronous=True)
    belief = replace(cfg.belief, centroids=False)
    cfg = _no_verification(_no_centroid_selection(_pd(cfg)))
    cfg = replace(cfg, planner=replace(cfg.planner, algorithm="paper"))
    return _alone(_asked_near(replace(cfg, belief=belief, pilot=pilot, latency="fixed:5")))


def _rule_based(cfg: MissionCfg) -> MissionCfg:
    """The nearest unvisited centroid in place of the advisor; where none is known, the nearest frontier."""
    return _alone(replace(cfg, decider="nearest", latency="0"))


def _rule_based_dots_only(cfg: MissionCfg) -> MissionCfg:
    """The paper's rule to the letter: on the paper's pipeline, and without a goal when no unvisited dot is known.

    The paper (IV-D) names the nearest unvisited centroid, and no rule for water where none is known yet.
    """
    cfg = _rule_based(_paper(cfg))
    return replace(cfg, planner=replace(cfg.planner, explore=False))


def _frontier(cfg: MissionCfg) -> MissionCfg:
    """Frontier exploration (Yamauchi 1997), blind to oysters."""
    return _alone(_asked_near(replace(_planned_before(_no_centroid_selection(cfg)), decider="frontier", latency="0")))


def _lawnmower(cfg: MissionCfg) -> MissionCfg:
    """Lanes over the whole area, planned before the dive; in a mission in words, over whatever lies on them."""
    told = replace(cfg.planner.instruction, clear_m=0.0)
    cfg = replace(cfg, planner=replace(cfg.planner, instruction=told))
    return _alone(_asked_near(replace(_planned_before(_no_centroid_selection(cfg)), decider="lawnmower", latency="0")))


def _random(cfg: MissionCfg) -> MissionCfg:
    """The whole system, but its advisor draws lots among the candidates; it takes as long to answer as the rules."""
    return _alone(replace(cfg, decider="random"))


def _random_unchecked(cfg: MissionCfg) -> MissionCfg:
    """Drive wherever the random advisor draws: what chance is worth without verification."""
    return _no_verification(_random(cfg))


def _glided(cfg: MissionCfg) -> MissionCfg:
    """Use a vehicle without inertia that follows a plan to its end."""
    vehicle = replace(cfg.simulator.vehicle, model="kinematic")
    return replace(cfg, latency="0", stop_when_covered=False, simulator=replace(cfg.simulator, vehicle=vehicle))


def _blind_sweep(cfg: MissionCfg) -> MissionCfg:
    """Drive straight lanes at cruise speed, without sensing and through all obstacles; each contact counts."""
    cfg = replace(cfg, simulator=replace(cfg.simulator, contact="ghost"))
    return replace(_glided(cfg), decider="sweep")


def _oracle(cfg: MissionCfg) -> MissionCfg:
    """Drive a short tour past everything, planned on the true reef: a reference, not a method."""
    return replace(_glided(cfg), decider="oracle")


def _geometry(cfg: MissionCfg) -> MissionCfg:
    """Rules that are told the conditions of a mission in words without its kinds: what geometry can do."""
    return _alone(replace(cfg, decider="geometry"))


def _keywords(cfg: MissionCfg) -> MissionCfg:
    """Rules that read key words of a mission in words, and see no pictures."""
    return _alone(replace(cfg, decider="keywords"))


def _reader(cfg: MissionCfg) -> MissionCfg:
    """Understands a mission in words and sees, in truth, what it has been near: a control, not a method."""
    return _alone(replace(cfg, decider="reader"))


VARIANTS: dict[str, Change] = {
    "full": lambda cfg: cfg,
    "paper": _paper,
    "pd": _pd,
    "dream": _dream,
    "rule-based": _rule_based,
    "rule-based-dots-only": _rule_based_dots_only,
    "frontier": _frontier,
    "lawnmower": _lawnmower,
    "no-verification": _no_verification,
    "no-centroid-selection": _no_centroid_selection,
    "no-trigger": _no_trigger,
    "no-ddp": _no_ddp,
    "no-cost-to-go": _no_cost_to_go,
    "no-cost-to-go-no-ddp": _no_cost_to_go_no_ddp,
    "no-topology": _no_topology,
    "random": _random,
    "random-unchecked": _random_unchecked,
    "blind-sweep": _blind_sweep,
    "oracle": _oracle,
    "geometry": _geometry,
    "keywords": _keywords,
    "reader": _reader,
}


def apply_variant(name: str, cfg: MissionCfg) -> MissionCfg:
    """Return `cfg` with the changes of a named variant.

    Raises:
        InputError: There is no such variant.
    """
    if name not in VARIANTS:
        raise InputError("--variant", "", repr(name), f"one of {', '.join(VARIANTS)}{nearest(name, VARIANTS)}")
    return VARIANTS[name](cfg)

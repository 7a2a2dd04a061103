"""Baselines and ablations as configurations of the one pipeline (paper IV-C, IV-D)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from coral.errors import InputError, nearest
from coral.reef.mission import MissionCfg

Change = Callable[[MissionCfg], MissionCfg]


def _no_verification(cfg: MissionCfg) -> MissionCfg:
    """Chosen points go to the controller unchecked; violations are counted."""
    planner = replace(cfg.planner, verify=replace(cfg.planner.verify, enabled=False))
    return replace(cfg, planner=planner)


def _no_centroid_selection(cfg: MissionCfg) -> MissionCfg:
    """The chain is shown, but only free waypoints are asked for."""
    return replace(cfg, planner=replace(cfg.planner, centroid_selection=False))


def _no_topology(cfg: MissionCfg) -> MissionCfg:
    """Judge every choice by its surroundings alone, as in the paper."""
    return replace(cfg, planner=replace(cfg.planner, topology=replace(cfg.planner.topology, enabled=False)))


def _fixed_angles(cfg: MissionCfg) -> MissionCfg:
    """Choices are judged by the paper's fixed angles (Eqs. 4-8), not by the tour that they lead to."""
    return replace(cfg, planner=replace(cfg.planner, verify=replace(cfg.planner.verify, by="angles")))


def _paper(cfg: MissionCfg) -> MissionCfg:
    """As the paper has it: nothing asked ahead, clusters visited by distance, fixed angles, no topological memory."""
    belief = replace(cfg.belief, inspect=replace(cfg.belief.inspect, enabled=False))
    planner = replace(cfg.planner, route=replace(cfg.planner.route, ahead=False))
    return _no_topology(_fixed_angles(replace(cfg, belief=belief, planner=planner)))


def _no_trigger(cfg: MissionCfg) -> MissionCfg:
    """The advisor is asked again at every cooldown."""
    return replace(cfg, pilot=replace(cfg.pilot, trigger=replace(cfg.pilot.trigger, always=True)))


def _no_ddp(cfg: MissionCfg) -> MissionCfg:
    """Uniform intervals, every boundary point at every step."""
    return replace(cfg, controller=replace(cfg.controller, uniform=True))


def _pd(cfg: MissionCfg) -> MissionCfg:
    """A PD controller in place of DDP-MPPI ("w/o low-level planner").

    It goes through what it hits: the paper's PD still covers 91 %, so its contacts cannot have stopped the vehicle,
    and against solid obstacles ours stays leaning on the first one.
    """
    return replace(cfg, driver="pd", simulator=replace(cfg.simulator, contact="ghost"))


def _dream(cfg: MissionCfg) -> MissionCfg:
    """DREAM (paper IV-C, IV-E): one action of 1 s for each answer, standing still meanwhile; PD, no chain, no checks.

    Its own action set and gains are not public: an action here is a second's drive towards the chosen waypoint.
    """
    trigger = replace(cfg.pilot.trigger, always=True, cooldown_s=0.0)
    pilot = replace(cfg.pilot, trigger=trigger, synchronous=True)
    return replace(_no_verification(_no_centroid_selection(_pd(cfg))), pilot=pilot, latency="fixed:5")


def _rule_based(cfg: MissionCfg) -> MissionCfg:
    """The nearest unvisited centroid in place of the advisor; where none is known, the nearest frontier."""
    return replace(cfg, decider="nearest", latency="0")


def _frontier(cfg: MissionCfg) -> MissionCfg:
    """Frontier exploration (Yamauchi 1997), blind to oysters."""
    return replace(_no_verification(_no_centroid_selection(cfg)), decider="frontier", latency="0")


def _lawnmower(cfg: MissionCfg) -> MissionCfg:
    """Lanes over the whole area, planned before the dive."""
    return replace(_no_verification(_no_centroid_selection(cfg)), decider="lawnmower", latency="0")


def _random(cfg: MissionCfg) -> MissionCfg:
    """The whole system, but its advisor draws lots among the candidates; it takes as long to answer as the rules."""
    return replace(cfg, decider="random")


def _glided(cfg: MissionCfg) -> MissionCfg:
    """A vehicle without inertia on a plan of its own, to the end of it."""
    vehicle = replace(cfg.simulator.vehicle, model="kinematic")
    return replace(cfg, latency="0", stop_when_covered=False, simulator=replace(cfg.simulator, vehicle=vehicle))


def _blind_sweep(cfg: MissionCfg) -> MissionCfg:
    """Straight lanes at cruise speed without looking, through whatever is in the way; each contact counts."""
    cfg = replace(cfg, simulator=replace(cfg.simulator, contact="ghost"))
    return replace(_glided(cfg), decider="sweep")


def _oracle(cfg: MissionCfg) -> MissionCfg:
    """A short tour past everything, planned on the truth: a bound, not a method."""
    return replace(_glided(cfg), decider="oracle")


VARIANTS: dict[str, Change] = {
    "full": lambda cfg: cfg,
    "paper": _paper,
    "fixed-angles": _fixed_angles,
    "pd": _pd,
    "dream": _dream,
    "rule-based": _rule_based,
    "frontier": _frontier,
    "lawnmower": _lawnmower,
    "no-verification": _no_verification,
    "no-centroid-selection": _no_centroid_selection,
    "no-trigger": _no_trigger,
    "no-ddp": _no_ddp,
    "no-topology": _no_topology,
    "random": _random,
    "blind-sweep": _blind_sweep,
    "oracle": _oracle,
}


def apply_variant(name: str, cfg: MissionCfg) -> MissionCfg:
    """The configuration of a named variant, on top of `cfg`.

    Raises:
        InputError: There is no such variant.
    """
    if name not in VARIANTS:
        raise InputError("--variant", "", repr(name), f"one of {', '.join(VARIANTS)}{nearest(name, VARIANTS)}")
    return VARIANTS[name](cfg)

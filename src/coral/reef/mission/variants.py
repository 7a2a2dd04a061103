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


def _full(cfg: MissionCfg) -> MissionCfg:
    """Nothing is changed."""
    return cfg


def _no_verification(cfg: MissionCfg) -> MissionCfg:
    """Chosen points go to the controller without a check, into an obstacle if need be.

    Only points outside the survey area are refused. Violations are counted.
    """
    return replace(cfg, planner=replace(cfg.planner, checks=False))


def _planned_before(cfg: MissionCfg) -> MissionCfg:
    """Chosen points need only lie in open water within reach: they do not depend on what has been found."""
    return replace(cfg, planner=replace(cfg.planner, provable=replace(cfg.planner.provable, finished=False)))


def _alone(cfg: MissionCfg) -> MissionCfg:
    """Whoever decides stands alone: no rules step in where its answers fail."""
    fallback: Fallback = "hold" if cfg.pilot.fallback == "rules" else cfg.pilot.fallback
    return replace(cfg, pilot=replace(cfg.pilot, fallback=fallback))


def _no_centroid_selection(cfg: MissionCfg) -> MissionCfg:
    """The advisor sees the chain, but is asked only for free waypoints."""
    return replace(cfg, planner=replace(cfg.planner, centroid_selection=False))


def _no_topology(cfg: MissionCfg) -> MissionCfg:
    """No tour of what is left is planned: the mode follows Alg. 2, and no choice is priced."""
    return replace(cfg, planner=replace(cfg.planner, topology=replace(cfg.planner.topology, enabled=False)))


def _asked_near(cfg: MissionCfg) -> MissionCfg:
    """The next goal is asked for near the present one and measured from the robot."""
    return replace(cfg, planner=replace(cfg.planner, route=replace(cfg.planner.route, ahead=False)))


def _paper(cfg: MissionCfg) -> MissionCfg:
    """The paper's Alg. 2 in place of our planner.

    Its prompts (five points, priority rules), one goal at a time, asked for 2.5 m before the present one and measured
    from the robot, checked by Eqs. 4-8 at request and response; refusals that name only the failure mode; 1 m from the
    previous goal, 50 s between questions, a cluster visited within 3 m of its centre.
    """
    belief = replace(cfg.belief, inspect=replace(cfg.belief.inspect, enabled=False))
    trigger = replace(cfg.pilot.trigger, cooldown_s=PAPER_COOLDOWN_S)
    cfg = replace(cfg, belief=belief, pilot=replace(cfg.pilot, trigger=trigger))
    return _asked_near(replace(cfg, planner=replace(cfg.planner, algorithm="paper")))


def _no_trigger(cfg: MissionCfg) -> MissionCfg:
    """The advisor is asked again after every cooldown."""
    return replace(cfg, pilot=replace(cfg.pilot, trigger=replace(cfg.pilot.trigger, always=True)))


def _no_ddp(cfg: MissionCfg) -> MissionCfg:
    """All rollout steps have the same fidelity: equal intervals, every boundary point at every step."""
    return replace(cfg, controller=replace(cfg.controller, uniform=True))


def _no_cost_to_go(cfg: MissionCfg) -> MissionCfg:
    """The controller is given the straight distance to its goal instead of the way around known obstacles.

    Only its rollouts, 3 m long, see what lies between.
    """
    return replace(cfg, pilot=replace(cfg.pilot, cost_to_go=False))


def _no_cost_to_go_no_ddp(cfg: MissionCfg) -> MissionCfg:
    """Both: what DDP is worth to a local planner alone."""
    return _no_ddp(_no_cost_to_go(cfg))


def _pd(cfg: MissionCfg) -> MissionCfg:
    """A PD controller drives; it passes through what it hits, and each contact is counted ("w/o low-level planner").

    The paper's PD still covers 91 %, so contacts cannot have stopped that vehicle.
    Against solid obstacles ours stays at the first one.
    """
    return replace(cfg, driver="pd", simulator=replace(cfg.simulator, contact="ghost"))


def _dream(cfg: MissionCfg) -> MissionCfg:
    """DREAM, the earlier system that the paper compares with, rebuilt from its description (IV-C, IV-E).

    One action of one second per answer, one answer every 5 s whatever `--cfg.latency` says, standing still in between;
    PD control; no chain in its pictures, prompt or facts, only the green cells of the map; no check except that a point
    lies in the survey area. Its own actions and gains are not public: an action here is a second's drive towards the
    chosen waypoint.
    """
    trigger = replace(cfg.pilot.trigger, always=True, cooldown_s=0.0)
    pilot = replace(cfg.pilot, trigger=trigger, synchronous=True)
    belief = replace(cfg.belief, centroids=False)
    cfg = _no_verification(_no_centroid_selection(_pd(cfg)))
    cfg = replace(cfg, planner=replace(cfg.planner, algorithm="paper"))
    return _alone(_asked_near(replace(cfg, belief=belief, pilot=pilot, latency="fixed:5")))


def _rule_based(cfg: MissionCfg) -> MissionCfg:
    """Always drives to the nearest unvisited cluster, or to the nearest unexplored water if none is known."""
    return _alone(replace(cfg, decider="nearest", latency="0"))


def _rule_based_dots_only(cfg: MissionCfg) -> MissionCfg:
    """The same rule in the `paper` variant, without exploring (`--cfg.planner.no-explore`).

    If no unvisited cluster is known, the robot stays where it is: the paper (IV-D) names the nearest unvisited
    centroid, and no rule for water where none is known yet.
    """
    cfg = _rule_based(_paper(cfg))
    return replace(cfg, planner=replace(cfg.planner, explore=False))


def _frontier(cfg: MissionCfg) -> MissionCfg:
    """Frontier exploration (Yamauchi 1997) that ignores oysters."""
    return _alone(_asked_near(replace(_planned_before(_no_centroid_selection(cfg)), decider="frontier", latency="0")))


def _lawnmower(cfg: MissionCfg) -> MissionCfg:
    """Parallel lanes over the whole area, planned before the dive; in a mission in words also over dots."""
    told = replace(cfg.planner.instruction, clear_m=0.0)
    cfg = replace(cfg, planner=replace(cfg.planner, instruction=told))
    return _alone(_asked_near(replace(_planned_before(_no_centroid_selection(cfg)), decider="lawnmower", latency="0")))


def _random(cfg: MissionCfg) -> MissionCfg:
    """The whole system, but the advisor draws lots among what is offered; it takes as long as the rules."""
    return _alone(replace(cfg, decider="random"))


def _random_unchecked(cfg: MissionCfg) -> MissionCfg:
    """The same without verification: the robot drives wherever the draw says."""
    return _no_verification(_random(cfg))


def _glided(cfg: MissionCfg) -> MissionCfg:
    """Use a vehicle without inertia that follows a plan to its end."""
    vehicle = replace(cfg.simulator.vehicle, model="kinematic")
    return replace(cfg, latency="0", stop_when_covered=False, simulator=replace(cfg.simulator, vehicle=vehicle))


def _blind_sweep(cfg: MissionCfg) -> MissionCfg:
    """Straight lanes 10 m apart (`--cfg.lane-m`) at cruise speed, without sensing.

    It passes through whatever is in the way; each contact is counted.
    """
    cfg = replace(cfg, simulator=replace(cfg.simulator, contact="ghost"))
    return replace(_glided(cfg), decider="sweep")


def _oracle(cfg: MissionCfg) -> MissionCfg:
    """A short tour past everything, planned on the true reef: a bound, not a method.

    In a mission in words it knows the kinds.
    """
    return replace(_glided(cfg), decider="oracle")


def _geometry(cfg: MissionCfg) -> MissionCfg:
    """In a mission in words: rules that know its conditions, but not the kinds of things."""
    return _alone(replace(cfg, decider="geometry"))


def _keywords(cfg: MissionCfg) -> MissionCfg:
    """In a mission in words: rules that read key words, and see no pictures."""
    return _alone(replace(cfg, decider="keywords"))


def _reader(cfg: MissionCfg) -> MissionCfg:
    """In a mission in words: a control that understands the words.

    It knows, in truth, what it has seen from within 5 m, or 60 % of the visibility.
    """
    return _alone(replace(cfg, decider="reader"))


VARIANTS: dict[str, Change] = {
    "full": _full,
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

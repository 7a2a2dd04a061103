"""Configuration of a contact episode."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from coral.config import Count
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningCfg
from coral.contact.control.reactive import ReactiveCfg
from coral.contact.episode.recorder import EpisodeRecordCfg
from coral.contact.perception.advisor_camera import AdvisorCameraCfg
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.policy.cfg import PolicyCfg
from coral.contact.thinker.think_cfg import ThinkCfg


@dataclass(frozen=True, kw_only=True)
class EpisodeCfg:
    """Everything that defines an episode besides the task, the world, the variant, the advisor and the seed."""

    replan_steps: Count = 2
    """Control steps that are taken from each plan. The paper takes one; two halve the time, and feedback runs at every
    step."""
    patience_plans: Count = 25
    """After so many plans in a row without one usable rehearsal the episode ends."""
    planning: PlanningCfg = field(default_factory=PlanningCfg)
    """The planning world."""
    controller: ControllerCfg = field(default_factory=ControllerCfg)
    """MPPI."""
    reactive: ReactiveCfg = field(default_factory=ReactiveCfg)
    """Feedback and limits."""
    record: EpisodeRecordCfg = field(default_factory=EpisodeRecordCfg)
    """What is kept."""
    think: ThinkCfg = field(default_factory=ThinkCfg)
    """How variants that ask an advisor think."""
    policy: PolicyCfg = field(default_factory=PolicyCfg)
    """A served policy, where one drives instead of the planner."""
    poses: Literal["tracked", "ground-truth"] = "tracked"
    """Where the objects' poses come from: tracked in a camera's pictures, or ground-truth, the simulator."""
    tracked: TrackedCfg = field(default_factory=TrackedCfg)
    """The camera and what is made of its pictures."""
    sight: AdvisorCameraCfg = field(default_factory=AdvisorCameraCfg)
    """The same camera's pictures that go with questions."""

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
    """Everything that defines an episode besides the task, the world, the variant, the advisor and the seed.

    Args:
        replan_steps: Control steps that are taken from each plan. The paper takes one; two halve the time, and feedback
            runs at every step.
        patience_plans: After so many plans in a row without one usable rehearsal the episode ends.
        planning: The planning world.
        controller: MPPI.
        reactive: Feedback and limits.
        record: What is kept.
        think: How variants that ask an advisor think.
        policy: A served policy, where one drives instead of the planner.
        poses: Where the objects' poses come from: tracked in a camera's pictures, or ground-truth, the simulator.
        tracked: The camera and what is made of its pictures.
        sight: The same camera's pictures that go with questions.
    """

    replan_steps: Count = 2
    patience_plans: Count = 25
    planning: PlanningCfg = field(default_factory=PlanningCfg)
    controller: ControllerCfg = field(default_factory=ControllerCfg)
    reactive: ReactiveCfg = field(default_factory=ReactiveCfg)
    record: EpisodeRecordCfg = field(default_factory=EpisodeRecordCfg)
    think: ThinkCfg = field(default_factory=ThinkCfg)
    policy: PolicyCfg = field(default_factory=PolicyCfg)
    poses: Literal["tracked", "ground-truth"] = "tracked"
    tracked: TrackedCfg = field(default_factory=TrackedCfg)
    sight: AdvisorCameraCfg = field(default_factory=AdvisorCameraCfg)

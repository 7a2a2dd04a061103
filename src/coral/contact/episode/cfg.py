"""Configuration of a contact episode."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from coral.config import Count
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningCfg
from coral.contact.control.reactive import ReactiveCfg
from coral.contact.episode.policy_cfg import PolicyCfg
from coral.contact.episode.recorder import EpisodeRecordCfg
from coral.contact.episode.referee import JudgedBy
from coral.contact.perception.advisor_camera import AdvisorCameraCfg
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.thinker.think_cfg import ThinkCfg
from coral.contact.worlds.franka_cfg import FrankaCfg


@dataclass(frozen=True, kw_only=True)
class EpisodeCfg:
    """Complete definition of an episode, apart from task, world, variant, advisor and seed."""

    replan_steps: Count = 2
    """Control steps executed per plan. Departs from the paper: it executes one; two halve the
    time, and feedback runs at every step."""
    planning: PlanningCfg = field(default_factory=PlanningCfg)
    """The planning world."""
    controller: ControllerCfg = field(default_factory=ControllerCfg)
    """The MPPI controller."""
    reactive: ReactiveCfg = field(default_factory=ReactiveCfg)
    """Reactive feedback and limits."""
    record: EpisodeRecordCfg = field(default_factory=EpisodeRecordCfg)
    """Contents of the run folder."""
    think: ThinkCfg = field(default_factory=ThinkCfg)
    """The outer loop of variants that ask an advisor."""
    policy: PolicyCfg = field(default_factory=PolicyCfg)
    """A served policy that acts instead of the planner."""
    poses: Literal["tracked", "ground-truth"] = "tracked"
    """Source of the objects' poses: tracked in a camera's pictures, or ground-truth, the simulator."""
    judged_by: JudgedBy = "truth"
    """Who decides about success: truth, which only a simulation knows; perception, the measured poses, where no
    condition of the task reads contacts; operator, a person at the keyboard."""
    franka: FrankaCfg = field(default_factory=FrankaCfg)
    """The arm of the world franka."""
    tracked: TrackedCfg = field(default_factory=TrackedCfg)
    """The camera, the tracker and the filter."""
    sight: AdvisorCameraCfg = field(default_factory=AdvisorCameraCfg)
    """Pictures of the same camera for questions."""

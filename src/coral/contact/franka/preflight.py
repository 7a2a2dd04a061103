"""The list that is gone through before an arm may move."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from coral.check_line import CheckLine, Level, level_of
from coral.contact.franka.limits import Limits
from coral.contact.franka.stream import StreamReport
from coral.contact.scene.observation import BodyState
from coral.contact.worlds.franka_cfg import FrankaCfg

REACH_M = 0.9
"""An object farther than this from the arm's foot is none that it can handle, or has a wrong pose."""
BELOW_M = 0.05
"""Nor is one whose origin is this far below the table's top."""
RESTING_RAD_S = 0.02
"""Joints faster than this are in motion."""
MARKS: Mapping[Level, str] = {"good": "ok   ", "blocking": "NO   "}


def preflight_arm(report: StreamReport, cfg: FrankaCfg, objects: Sequence[str]) -> tuple[CheckLine, ...]:
    """Check what the arm and the poses say while nothing moves."""
    state = report.state
    if state is None:
        return (CheckLine("the arm sends its state", "none has come", "blocking"),)
    fastest = float(np.abs(state.joint_speeds).max())
    beyond = Limits(cfg).violation(replace(state, joint_speeds=np.zeros(7), twist=np.zeros(6)), np.zeros(6))
    x, y, z = state.position + np.asarray(cfg.base_m)
    force = float(np.linalg.norm(report.wrench[:3]))
    pull = f"{force:.1f} N, taken as bias once the arm is in its start posture"
    return (
        CheckLine("the arm sends its state", f"arm's clock {state.time_s:.2f} s"),
        CheckLine("the arm is at rest", f"fastest joint {fastest:.3f} rad/s", level_of(not fastest < RESTING_RAD_S)),
        CheckLine("within all limits", beyond or f"tool at {x:+.3f} {y:+.3f} {z:+.3f} m", level_of(bool(beyond))),
        CheckLine("nothing pulls at the hand", pull, level_of(not force < cfg.limits.push_n)),
        *(_seen(name, report.objects.get(name), report.ages_s.get(name, 0.0), cfg) for name in objects),
    )


def _seen(name: str, pose: BodyState | None, age_s: float, cfg: FrankaCfg) -> CheckLine:
    title = f"{name} is seen within reach"
    if pose is None or age_s > cfg.poses_timeout_s:
        late = "never" if pose is None else f"{age_s:.1f} s ago"
        return CheckLine(title, f"last pose {late}; poses arrive at UDP port {cfg.poses_port}", "blocking")
    x, y, z = pose.position
    far = float(np.linalg.norm(pose.position - np.asarray(cfg.base_m)))
    within = far < REACH_M and z > -BELOW_M
    return CheckLine(title, f"at {x:+.3f} {y:+.3f} {z:+.3f} m", level_of(not within))

"""The LIBERO convention of observations and actions, used by most published policies for a Panda.

Action: seven numbers from -1 to 1: a step of the position, a rotation, and the
fingers; robosuite's operational-space controller scales them. Sources: openpi's `examples/libero`, LIBERO's tabletop
arena, robosuite's OSC_POSE defaults.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from coral.contact.control.hand_model import MAX_OPENING_M, SQUEEZE_M
from coral.contact.episode.policy_cfg import LiberoCfg
from coral.contact.policy.client import PolicyError
from coral.contact.scene.geometry import from_rotvec, multiply
from coral.contact.scene.observation import Array, HandTarget, Observation

MOST_ACTIONS = 1000
OBSERVATION = {
    "observation/image": "LIBERO's camera across the table, ray-cast: bytes, RGB.",
    "observation/wrist_image": "The same from robosuite's camera at the wrist.",
    "observation/state": "8 numbers: position of the tool in LIBERO's world (m), its orientation as axis times angle "
    "(rad), both finger joints (m).",
    "prompt": "The task's instruction.",
}
"""What a policy is sent, in this order."""


def state(now: Observation, cfg: LiberoCfg) -> Array:
    """Compute the robot's state, Shape=(8,)."""
    fingers = [now.opening_m / 2, -now.opening_m / 2]
    return np.concatenate([now.tool.position + cfg.origin_m, axis_angle(now.tool.quaternion), fingers])


def axis_angle(quaternion: Array) -> Array:
    """Convert to axis times angle (rad), Shape=(3,), with x not negative.

    A hand that points down is half a turn about x, where the shortest vector jumps between +pi and -pi; the policies
    were trained with +pi, and with angles beyond it.
    """
    q = quaternion if quaternion[1] >= 0 else -quaternion
    sine = float(np.linalg.norm(q[1:]))
    return np.asarray(q[1:] * (2.0 * np.arctan2(sine, q[0]) / sine)) if sine > 1e-9 else np.zeros(3)


def actions_of(answer: Mapping[Any, Any]) -> Array:
    """Read the actions in a server's answer, Shape=(n, 7).

    Raises:
        PolicyError: There are no actions ("bad-actions"), or they are not finite ("not-finite").
    """
    found = answer.get("actions", answer.get(b"actions"))
    if found is None:
        raise PolicyError("bad-actions", "the answer has no actions")
    if not isinstance(found, np.ndarray) or found.dtype.kind not in "iuf":
        what = f"an array of {found.dtype}" if isinstance(found, np.ndarray) else f"a {type(found).__name__}"
        raise PolicyError("bad-actions", f"the actions are {what}, expected an array of numbers")
    if found.ndim != 2 or found.shape[1] != 7 or not 1 <= len(found) <= MOST_ACTIONS:
        expected = f"expected (n, 7) with n from 1 to {MOST_ACTIONS}"
        raise PolicyError("bad-actions", f"actions of shape {found.shape}, {expected}")
    actions = found.astype(np.float64)
    if not np.isfinite(actions).all():
        raise PolicyError("not-finite", "the actions hold something that is no number")
    return actions


def target(now: Observation, action: Array, cfg: LiberoCfg) -> HandTarget:
    """Convert an action, Shape=(7,), clipped to -1 and 1, to a target of the hand, relative to its measured pose.

    `now` is observed at the start of the action; the target keeps its opening.
    """
    step = np.clip(action, -1.0, 1.0)
    return HandTarget(
        position=now.tool.position + cfg.step_m * step[:3],
        quaternion=multiply(from_rotvec(cfg.step_rad * step[3:6]), now.tool.quaternion),  # about the world's axes
        opening_m=now.opening_m,
        stiffness=cfg.stiffness_n_m,
    )


def opened(opening_m: float, action: Array, cfg: LiberoCfg) -> float:
    """Compute the commanded opening (m) one tick later; the sign of the action's last number gives the direction."""
    closing = float(np.sign(action[6])) * (1.0 if cfg.gripper == "positive" else -1.0)
    return float(np.clip(opening_m - closing * cfg.opening_m_s * cfg.tick_s, SQUEEZE_M, MAX_OPENING_M))

"""Configuration of episodes with a served policy."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal

from pydantic import Field

from coral.config import Count, NonNegative, Positive, Signed


@dataclass(frozen=True, kw_only=True)
class ClientCfg:
    """Deadlines and limits."""

    connect_s: Positive = 10.0
    """Time to connect and receive the server's metadata."""
    answer_s: Positive = 90.0
    """Time for one chunk of actions. A server that compiles at its first request may need a minute."""
    attempts: Count = 3
    """Maximum number of times that a request is sent if the connection fails, each time on a new one."""
    wait_s: NonNegative = 2.0
    """Wait between attempts."""
    most_bytes: Count = 4 * 2**20
    """Longest message; a chunk of fifty actions has 3 kB."""


@dataclass(frozen=True, kw_only=True)
class LiberoCfg:
    """Scales and rates of the convention."""

    pixels: Annotated[int, Field(ge=16, le=1024)] = 224
    """Width and height of both pictures (openpi's LIBERO example sends 224)."""
    rate_hz: Positive = 20.0
    """Actions per second (LIBERO's control frequency)."""
    ticks: Count = 5
    """World steps during one action, each within the reactive layer's limits."""
    execute: Count = 5
    """Number of actions of a chunk to execute before the next request (openpi's LIBERO example: 5)."""
    step_m: Positive = 0.05
    """Position step for an action of 1 (robosuite: 0.05)."""
    step_rad: Positive = 0.5
    """Rotation about each axis for an action of 1 (robosuite: 0.5)."""
    opening_m_s: Positive = 0.2
    """Speed of the finger opening; robosuite's gripper closes fully in eight actions."""
    gripper: Literal["positive", "negative"] = "positive"
    """Sign that closes the fingers: "positive" (LIBERO, robosuite) or "negative"."""
    stiffness_n_m: Positive = 675.0
    """Stiffness of the hand; robosuite's gain of 150 for its apparent mass of 4.5 kg."""
    origin_m: tuple[Signed, Signed, Signed] = (-0.16, 0.0, 0.9)
    """Our origin in LIBERO's world, whose table top is 0.9 m high and whose robot stands at x = -0.66."""

    @property
    def tick_s(self) -> float:
        """Return the control period of the world."""
        return 1.0 / (self.rate_hz * self.ticks)


@dataclass(frozen=True, kw_only=True)
class PolicyCfg:
    """How a served policy is run."""

    client: ClientCfg = field(default_factory=ClientCfg)
    """Deadlines and limits."""
    libero: LiberoCfg = field(default_factory=LiberoCfg)
    """Meaning of observations and actions."""

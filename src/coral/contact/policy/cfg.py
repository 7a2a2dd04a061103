"""Configuration of episodes with a served policy."""

from __future__ import annotations

from dataclasses import dataclass, field

from coral.contact.policy.cameras import PolicyCamerasCfg
from coral.contact.policy.client import ClientCfg
from coral.contact.policy.libero_convention import LiberoCfg


@dataclass(frozen=True, kw_only=True)
class PolicyCfg:
    """How a served policy is run."""

    client: ClientCfg = field(default_factory=ClientCfg)
    """Deadlines and limits."""
    libero: LiberoCfg = field(default_factory=LiberoCfg)
    """Meaning of observations and actions."""
    eyes: PolicyCamerasCfg = field(default_factory=PolicyCamerasCfg)
    """The cameras."""

"""Everything that defines how a served policy is run."""

from __future__ import annotations

from dataclasses import dataclass, field

from coral.contact.policy.cameras import PolicyCamerasCfg
from coral.contact.policy.client import ClientCfg
from coral.contact.policy.libero_convention import LiberoCfg


@dataclass(frozen=True, kw_only=True)
class PolicyCfg:
    """A served policy, in episodes that one drives.

    Args:
        client: Patience with the server.
        libero: What observations and actions mean.
        eyes: The cameras.
    """

    client: ClientCfg = field(default_factory=ClientCfg)
    libero: LiberoCfg = field(default_factory=LiberoCfg)
    eyes: PolicyCamerasCfg = field(default_factory=PolicyCamerasCfg)

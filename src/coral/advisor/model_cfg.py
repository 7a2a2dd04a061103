"""Calls of real models: deadlines, retries, output mode, and spending limits."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

OutputMode = Literal["auto", "native", "tool", "prompted", "plain"]


NOBODY = "nothing answers at that address"
CONNECT_S = 3.0
"""Time in which a server that is there accepts a connection, over a satellite too (s)."""


@dataclass(frozen=True, kw_only=True)
class SpendCfg:
    """Limits of one run, over all its decisions; reaching one ends asking with a clear message."""

    max_calls: int = 200
    """Requests over the wire, retries included. A mission of the paper takes about 5 to 20 decisions."""
    max_tokens: int = 2_000_000
    """Input and output tokens together."""
    max_usd: float = 10.0
    """Cost (USD), as far as the provider's price is known."""


@dataclass(frozen=True, kw_only=True)
class ModelCfg:
    """Settings of calls to a real model."""

    output: OutputMode = "auto"
    """How the format of the answer is requested: the provider's JSON schema (native), a tool call (tool), a schema
    in the prompt with a JSON response format (prompted) or without (plain). auto: native for the named providers,
    plain for a local server, because local servers differ (`coral advisor probe` tests one)."""
    attempt_timeout_s: float = 45.0
    """Longest wait for one reply (s, wall)."""
    deadline_s: float = 60.0
    """Longest wait for one answer, retries and format repair included (s, wall). Client libraries apply their own
    time-out per attempt and retry silently; this one is hard."""
    max_retries: int = 3
    """Further requests after 429, 5xx, or a dropped connection."""
    backoff_s: float = 0.5
    """First pause before a retry (s); it doubles each time. A Retry-After header takes precedence."""
    format_repairs: int = 1
    """Further requests after a reply that does not parse, with the reason."""
    max_reply_bytes: int = 1_000_000
    """A longer reply is truncated during transfer and counts as malformed."""
    max_output_tokens: int = 4096
    temperature: float | None = None
    """None is the provider's default; some models refuse any value."""
    pictures: bool = True
    """False for a model without vision, which answers HTTP 400 or 500 to a picture."""
    facts: bool = False
    """Whether the numbers of `Question.facts` are added to the prompt (a separate experiment)."""
    spend: SpendCfg = field(default_factory=SpendCfg)

"""Questions to an advisor, and its replies."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar

from pydantic import BaseModel

A = TypeVar("A", bound=BaseModel)
Affine = tuple[tuple[float, float, float], tuple[float, float, float]]
"""A planar affine map, two rows of three."""


@dataclass(frozen=True, kw_only=True)
class Picture:
    """One PNG of a question."""

    name: str
    """Short file-name stem, unique within the question ("map", "segmentation", "depth")."""
    png: bytes
    caption: str = ""
    pixel_from_world: Affine | None = None
    """Map from the world to the picture, for advisors that point: (column, row) px = A (x, y, 1), x and y in m. None
    if the picture shows no plane of the world."""

    @property
    def digest(self) -> str:
        """Compute SHA-256 of the PNG bytes, hexadecimal."""
        return hashlib.sha256(self.png).hexdigest()


@dataclass(frozen=True, kw_only=True)
class Question(Generic[A]):
    """One question, complete in itself: an advisor needs nothing else to answer it."""

    kind: str
    """Kind, which names its template, such as "reef-centroid"."""
    prompt: str
    answer_type: type[A]
    """Pydantic model that the answer must validate against."""
    facts: Mapping[str, Any]
    """Contents of the pictures as JSON numbers, from the robot's own map and sensors, never ground truth."""
    pictures: tuple[Picture, ...] = ()
    prompt_version: str = "1"
    asked_at_s: float = 0.0
    """Time of the question on the clock of the world; `consult` records it."""


@dataclass(frozen=True, kw_only=True)
class Rejection:
    """The reason why an answer was refused, in words that the model can act on."""

    code: str
    """Stable identifier for logs and tests, such as "backward" or "not-json"."""
    reason: str
    details: Mapping[str, Any] = field(default_factory=dict)
    listing: str = ""
    """What was written in the refused answer, with the faults beside it: prompts show it below the reason."""


@dataclass(frozen=True, kw_only=True)
class Usage:
    """Cost of one reply."""

    input_tokens: int = 0
    output_tokens: int = 0
    cost_usd: float = 0.0
    requests: int = 1
    faults: tuple[str, ...] = ()
    """Faults that were repaired or retried before this reply, in order, such as "http-429"."""


@dataclass(frozen=True, kw_only=True)
class Reply(Generic[A]):
    """A parsed answer, with the raw text of the reply."""

    value: A
    raw: str
    usage: Usage = Usage(requests=0)
    latency_s: float | None = None
    """Latency of the answer, if the advisor knows better than the clock (a recording); infinite for never."""


class BadAnswer(Exception):
    """The reply does not validate. The reason goes back to the model."""

    def __init__(
        self, code: str, reason: str, raw: str = "", usage: Usage | None = None, latency_s: float | None = None
    ) -> None:
        super().__init__(reason)
        self.rejection = Rejection(code=code, reason=reason)
        self.raw = raw
        self.usage = usage or Usage()
        self.latency_s = latency_s
        """Latency, as in `Reply`."""


class AdvisorUnavailable(Exception):
    """There is no reply (network, time-out, budget). `code` names the failure in the attempt log."""

    def __init__(
        self, code: str, reason: str, *, final: bool = False, latency_s: float | None = None, usage: Usage | None = None
    ) -> None:
        super().__init__(reason)
        self.code, self.reason = code, reason
        self.final = final
        """Whether asking again cannot help (budget exhausted, key refused)."""
        self.latency_s = latency_s
        """Latency, as in `Reply`."""
        self.usage = usage or Usage(requests=0)


class Withdrawn(Exception):
    """The question was withdrawn while pending: its answer is no longer needed."""


class Advisor(Protocol):
    """Answers questions: rules, a foundation model, a person at a desk, a recording."""

    name: str

    async def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Reply[A]:
        """Answer a question, given the reasons for refusing earlier answers.

        Raises:
            BadAnswer: The reply does not validate.
            AdvisorUnavailable: There is no reply.
        """


def trait(advisor: Any, name: str, default: Any = None) -> Any:
    """Return an attribute of an advisor, or of the one inside it: a wrapper changes answers and nothing else."""
    while advisor is not None:
        if (found := getattr(advisor, name, None)) is not None:
            return found
        advisor = getattr(advisor, "inner", None)
    return default

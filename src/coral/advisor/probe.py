"""Probe of a model's endpoint: output modes, pictures, speed."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from coral.advisor.inner_loop import run_alone
from coral.advisor.model_cfg import ModelCfg, OutputMode
from coral.advisor.models import ModelAdvisor
from coral.advisor.preflight import small_question
from coral.advisor.question import AdvisorUnavailable, BadAnswer
from coral.advisor.registry import make_advisor, rules_alone
from coral.errors import InputError

MODES: tuple[OutputMode, ...] = ("native", "tool", "prompted", "plain")
"""The strictest first: the first that works is recommended."""

COLORS: Mapping[str, tuple[int, int, int]] = {"red": (220, 30, 30), "green": (30, 160, 60), "blue": (40, 70, 220)}


@dataclass(frozen=True, kw_only=True)
class Finding:
    """Outcome of one request."""

    works: bool
    says: str
    """"ok", or the fault."""
    wall_s: float


@dataclass(frozen=True, kw_only=True)
class ProbeReport:
    """The capabilities of an endpoint."""

    advisor: str
    modes: dict[str, Finding]
    """Finding of each output mode."""
    pictures: Finding | None
    """Whether it names the colours of pictures; None if no output mode works."""
    recommended: OutputMode | None
    """Output mode to configure (`output`)."""

    @property
    def usable(self) -> bool:
        """Return whether the model can be used at all."""
        return self.recommended is not None

    def lines(self) -> list[str]:
        """Return the report as text."""
        rows = [f"{self.advisor}"]
        rows += [f"  {mode:<9} {finding.wall_s:6.1f} s  {finding.says}" for mode, finding in self.modes.items()]
        if self.pictures is not None:
            rows.append(f"  {'pictures':<9} {self.pictures.wall_s:6.1f} s  {self.pictures.says}")
        if self.recommended is None:
            rows.append("  no output mode works")
        else:
            eyes = "" if self.pictures is not None and self.pictures.works else " --model.no-pictures"
            rows.append(f"  use it with: --advisor '{self.advisor}' --model.output {self.recommended}{eyes}")
        return rows


def probe(spec: str, cfg: ModelCfg | None = None, where: str = "MODEL") -> ProbeReport:
    """Ask `PROVIDER:MODEL` or `local:URL#MODEL` a few small questions (at most seven requests, a few hundred tokens).

    Retries and repairs are off, because the first reply is tested.

    Raises:
        InputError: The string names no real model, or the environment lacks its key.
    """
    base = replace(cfg or ModelCfg(), max_retries=0, format_repairs=0, facts=False)
    no_model = InputError(where, "", repr(spec), "a real model: PROVIDER:MODEL or local:URL#MODEL")
    if rules_alone(spec):
        raise no_model
    advisor = make_advisor(spec, rules={}, rng=np.random.default_rng(0), cfg=base, where=where)
    if not isinstance(advisor, ModelAdvisor):
        raise no_model
    return run_alone(_probe(advisor, base))


async def _probe(advisor: ModelAdvisor, base: ModelCfg) -> ProbeReport:
    modes: dict[str, Finding] = {}
    for mode in MODES:
        finding, gone = await _ask(advisor.with_cfg(replace(base, output=mode, pictures=False)), 7, "")
        modes[mode] = finding
        if gone in ("key-refused", "no-such-model", "connection"):
            break
    recommended = next((mode for mode in MODES if mode in modes and modes[mode].works), None)
    pictures = None
    if recommended is not None:
        seeing = advisor.with_cfg(replace(base, output=recommended, pictures=True))
        started = time.monotonic()
        findings = [(await _ask(seeing, number, color))[0] for number, color in enumerate(COLORS, start=2)]
        wrong = [finding for finding in findings if not finding.works]
        pictures = Finding(
            works=not wrong,
            wall_s=time.monotonic() - started,
            says=wrong[0].says if wrong else f"named {len(findings)} colours of {len(findings)}",
        )
    return ProbeReport(advisor=advisor.name, modes=modes, pictures=pictures, recommended=recommended)


async def _ask(advisor: ModelAdvisor, number: int, color: str) -> tuple[Finding, str]:
    """Ask one small question; return the finding and the code of the failure, if any."""
    question = small_question(number, COLORS.get(color))
    started = time.monotonic()
    code = ""
    try:
        answer = (await advisor.answer(question, ())).value
        right = answer.number == number and answer.color == (color or "none")
        says = (
            "ok"
            if right
            else f"wrong answer: number {answer.number} for {number}, color {answer.color} for {color or 'none'}"
        )
        # Only the format matters here: a weak model may support it although its content is wrong.
        works = right if color else True
    except BadAnswer as bad:
        works, says = False, f"{bad.rejection.code}: {bad.rejection.reason}"
    except AdvisorUnavailable as gone:
        works, code, says = False, gone.code, f"{gone.code}: {gone.reason}"
    await advisor.aclose()
    return Finding(works=works, says=" ".join(says.split())[:200], wall_s=time.monotonic() - started), code

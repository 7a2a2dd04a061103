"""`coral advisor probe`: capabilities of a model's endpoint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Annotated, Any

from coral.advisor.model_cfg import ModelCfg
from coral.exit_code import ExitCode
from coral.flags import Argument


@dataclass(frozen=True, kw_only=True)
class AdvisorProbe:
    """Ask a model a few small questions and report which output modes work and whether it sees pictures."""

    model: Annotated[str, Argument(metavar="MODEL")]
    """The model, as for --advisor: PROVIDER:MODEL or local:URL#MODEL."""
    json: bool = False
    """Print one JSON object."""
    cfg: ModelCfg = field(default_factory=ModelCfg)
    """Time-outs and retries."""

    def __call__(self) -> Mapping[str, Any]:
        from coral.advisor.probe import probe

        report = probe(self.model, self.cfg)
        return {**asdict(report), "usable": report.usable, "lines": report.lines()}

    def describe(self, result: Mapping[str, Any]) -> str:
        return "\n".join(result["lines"])

    def exit_code(self, result: Mapping[str, Any]) -> int:
        """Return a failure if the model cannot be used."""
        return ExitCode.DONE if result["usable"] else ExitCode.FAILED

"""`coral version`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from coral.package_version import __version__


@dataclass(frozen=True, kw_only=True)
class Version:
    """Print the version."""

    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        return {"version": __version__}

    def describe(self, result: Mapping[str, Any]) -> str:
        return f"coral {result['version']}"

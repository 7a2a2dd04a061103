"""CORAL and CoRAL: foundation models decide what to do, sampling-based optimal control decides how."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from coral.kernel_cache import guard_kernel_cache

if TYPE_CHECKING:
    from coral.interface.mission import MissionResult, run_mission
    from coral.interface.task import TaskResult, run_task

    __version__: str

__all__ = ["MissionResult", "TaskResult", "__version__", "run_mission", "run_task"]

guard_kernel_cache()

_HOMES = {
    "run_mission": "coral.interface.mission",
    "MissionResult": "coral.interface.mission",
    "run_task": "coral.interface.task",
    "TaskResult": "coral.interface.task",
    "__version__": "coral.package_version",
}


def __getattr__(name: str) -> Any:
    """Import a public name at its first use: `import coral` itself stays fast."""
    if name not in _HOMES:
        raise AttributeError(f"module 'coral' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """Show the public names alone."""
    return sorted(__all__)

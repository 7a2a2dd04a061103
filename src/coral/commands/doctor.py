"""`coral doctor` and `coral version`: what is installed."""

from __future__ import annotations

import importlib.util
import os
import platform
import shutil
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from coral.package_version import __version__

CORE = (
    "numpy", "numba", "opencv-python-headless", "pydantic", "pydantic-ai-slim", "httpx2", "rich", "PyYAML", "Jinja2",
    "jsonschema", "starlette", "matplotlib", "imageio-ffmpeg", "pyarrow", "mujoco", "websockets", "msgspec",
)  # fmt: skip
EXTRAS = {
    "contact": ("robosuite", "contact tasks on the Panda"),
    "ray": ("ray", "campaigns on a Ray cluster"),
    "slurm": ("submitit", "campaigns on a Slurm cluster"),
    "vision": ("onnxruntime", "missions by RGB pictures (--perception)"),
    "train": ("torch", "training networks for them (coral reef eyes train)"),
    "gym": ("gymnasium", "reefs and tasks as Gymnasium environments"),
    "vehicle": ("pymavlink", "a BlueROV2 by MAVLink"),
    "geo": ("pyproj", "maps with coordinates: GeoTIFF, GeoJSON, GeoPackage"),
    "bags": ("rosbags", "ROS 2 bags and MCAP files, read and written"),
    "franka": ("franky", "a Franka arm (coral contact run --world franka)"),
    "franka-sim": ("franky_sim", "a simulated arm that speaks a Franka arm's protocol"),
    "warp": ("mujoco_warp", "rollouts on an NVIDIA GPU (--cfg.planning.rollouts warp)"),
    "local": ("llama_cpp", "a small local language model for testing the wire"),
}
KEYS = ("OPENAI_API_KEY", "ANTHROPIC_API_KEY", "GOOGLE_API_KEY")


@dataclass(frozen=True, kw_only=True)
class Doctor:
    """Check Python, packages, the video encoder, write access, extras and model keys."""

    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        packages = {name: _version(name) for name in CORE}
        checks = {
            "python": sys.version_info >= (3, 11),
            "packages": all(packages.values()),
            "video encoder": _encoder(),
            "temporary folder": os.access(tempfile.gettempdir(), os.W_OK),
        }
        from coral.contact.cost_program.worker import CostWorker

        with CostWorker() as worker:
            filtered = worker.check()
        return {
            "ok": all(checks.values()),
            "checks": checks,
            "python": platform.python_version(),
            "packages": packages,
            "cores": os.cpu_count(),
            "costs_filtered": filtered,
            "browser": shutil.which("chromium") or shutil.which("google-chrome"),
            "extras": {name: _is_there(module) for name, (module, _) in EXTRAS.items()},
            "keys": {key: key in os.environ for key in KEYS},
        }

    def describe(self, result: Mapping[str, Any]) -> str:
        lines = [f"{'ok     ' if good else 'MISSING'}  {name}" for name, good in result["checks"].items()]
        lines += [f"MISSING  package {name}" for name, found in result["packages"].items() if not found]
        lines += [
            f"{'extra  ' if there else 'without'}  {name}: {EXTRAS[name][1]}"
            for name, there in result["extras"].items()
        ]
        lines.append(
            "ok       system calls of costs are filtered"
            if result["costs_filtered"]
            else "without  a filter of system calls: contact refuses costs (CORAL_ALLOW_UNFILTERED_COSTS=1 allows them)"
        )
        keys = [key for key, there in result["keys"].items() if there]
        lines.append(f"model keys in the environment: {', '.join(keys) or 'none (the heuristic advisor needs none)'}")
        lines.append("ready" if result["ok"] else "not ready: run make setup")
        return "\n".join(lines)


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _is_there(module: str) -> bool:
    """Check whether a module can be found; the parent of a dotted name is imported for that."""
    try:
        return importlib.util.find_spec(module) is not None
    except ImportError:
        return False


def _encoder() -> bool:
    try:
        import imageio_ffmpeg

        return bool(imageio_ffmpeg.get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        return False


@dataclass(frozen=True, kw_only=True)
class Version:
    """Print the version."""

    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        return {"version": __version__}

    def describe(self, result: Mapping[str, Any]) -> str:
        return f"coral {result['version']}"

"""`coral gui`: the front page in a browser."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from coral.contact.scene.task_names import every_task, task_path
from coral.errors import InputError
from coral.interrupts import wait_for_interrupt
from coral.reef.world.world_names import shipped_worlds, world_file
from coral.run_files import RunFiles
from coral.runs import new_run_folder
from coral.terminal import tell

SETTINGS: Mapping[str, Mapping[str, tuple[str, str, tuple[str, ...]]]] = {
    "reef": {
        "seed": ("seed", "0", ()),
        "preset": ("water and sensors", "clear", ("clear", "coast", "bay", "hard")),
        "advisor": ("advisor", "heuristic", ("heuristic", "desk", "sloppy:0.3:heuristic")),
        "variant": ("variant", "full", ("full", "paper")),
        "cfg.time-limit-s": ("time limit (s)", "600", ()),
        "live-speed": ("speed, times real time", "10", ()),
    },
    "contact": {
        "seed": ("seed", "0", ()),
        "world": ("world", "panda", ("panda", "hand")),
        "advisor": ("advisor", "recorded", ("recorded", "desk")),
        "variant": ("variant", "full", ("full", "paper", "expert-fsm")),
        "live-speed": ("speed, times real time", "1", ()),
    },
}
"""By system and flag: words for the page, the value at first, and suggestions. The command checks the value."""
FIRST: Mapping[str, str] = {"reef": "s1", "contact": "pick-box"}
"""What stands on the page at first."""


@dataclass(frozen=True, kw_only=True)
class Gui:
    """Open a page to start runs, watch them, answer their questions, read their reports, and compare two."""

    runs: Path = Path("runs")
    """Folder of the runs that the page lists and starts."""
    port: int = 8080
    """Port of the page on this machine; 0 chooses a free one."""
    json: bool = False
    """Print one JSON object at the end; the address goes to standard error."""

    def __call__(self) -> Mapping[str, Any]:
        from coral.desk.front.server import FrontServer

        root = self.runs.resolve()
        server = FrontServer(root, choices(), lambda wanted: command(wanted, root), port=self.port)
        tell(f"the front page is open at {server.url}")
        with server:
            wait_for_interrupt("Ctrl-C closes it, and stops the runs that it has started")
        return {"runs": str(root), "started": [str(job.folder) for job in server.jobs]}

    def describe(self, result: Mapping[str, Any]) -> str:
        return "\n".join(["the front page is closed", *(f"run folder: {folder}" for folder in result["started"])])


def choices() -> dict[str, Any]:
    """Return what the page offers, by system."""
    names = {"reef": [*shipped_worlds()], "contact": [*every_task()]}
    return {
        system: {
            "names": names[system],
            "first": FIRST[system],
            "settings": [
                {"flag": flag, "label": label, "value": value, "suggested": list(suggested)}
                for flag, (label, value, suggested) in settings.items()
            ],
        }
        for system, settings in SETTINGS.items()
    }


def command(wanted: Mapping[str, Any], root: Path) -> tuple[list[str], Path]:
    """Make the words of a command and its folder among the runs, from `system`, `name` and `settings` by flag.

    Raises:
        InputError: There is no such system, reef, task or setting.
    """
    system, name, settings = str(wanted.get("system")), wanted.get("name"), wanted.get("settings")
    if system not in SETTINGS:
        raise InputError("system", "", repr(system), f"one of {', '.join(SETTINGS)}")
    if not isinstance(name, str) or not name or name.startswith("-"):
        raise InputError("name", "", repr(name), "a reef, a task, or a file")
    if not isinstance(settings, Mapping) or not set(settings) <= set(SETTINGS[system]):
        raise InputError("settings", "", repr(settings)[:200], f"some of {', '.join(SETTINGS[system])}")
    (world_file if system == "reef" else task_path)(name)
    words = [system, "run", name]
    for flag, value in settings.items():
        words += [f"--{flag}", str(value)]
    folder = new_run_folder(root, Path(name).stem)
    folder.mkdir(parents=True, mode=0o700)
    if system == "contact" and settings.get("advisor") == "desk":
        words += ["--inbox", str(folder / RunFiles.INBOX)]
    return [*words, "--out", str(folder), "--live", "--no-wait", "--live-port", "0"], folder

"""What goes with a run where its wing is installed: live page, notice for the people at the desk, report and video."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from coral.errors import InputError
from coral.plugins import our_part
from coral.terminal import tell


@dataclass(frozen=True, kw_only=True)
class LiveFlags:
    """The flags of the page, among those of a command."""

    live: bool = False
    """Show the run in a browser while it goes on; its address is printed."""
    live_port: int = 8080
    """Port of the live page on this machine; 0 chooses a free one."""
    live_speed: float = 1.0
    """Speed limit of a live run, in multiples of real time; 0 for none. The page can change it."""
    wait: bool = True
    """With --live: begin when somebody has opened the page, and keep the page after the end until Ctrl-C."""

    def check(self) -> None:
        """Check the flags before anything is made.

        Raises:
            InputError: A flag is out of range, or the port is in use.
        """
        if not self.live:
            return
        our_part("live", "run", "--live")
        from coral.web import check_free

        if not self.live_speed >= 0:
            raise InputError("--live-speed", "", self.live_speed, "a number of 0 or more")
        check_free(self.live_port, "--live-port")


def watching(flags: LiveFlags, system: Literal["reef", "contact"], run: Any) -> AbstractContextManager[list[Any]]:
    """Give the observers that show a mission or an episode in a browser; none without `--live`."""
    if not flags.live:
        return nullcontext([])
    made: AbstractContextManager[list[Any]] = our_part("live", "run", "--live")(
        run, system, port=flags.live_port, speed=flags.live_speed, wait=flags.wait
    )
    return made


def mission_notice(
    asks_people: bool, inbox: Path, instruct: Callable[[str, str], bool] | None = None, **about: Any
) -> AbstractContextManager[Any]:
    """Keep a notice in the inbox while a mission runs; None where no people are asked, or the desk is not installed.

    instruct(words, by) changes the instruction of a mission in words; `about` describes the mission, in JSON values.
    """
    if not asks_people:
        return nullcontext()
    try:
        keep = our_part("notice", "desk", "--advisor")
    except InputError:
        return nullcontext()
    notice: AbstractContextManager[Any] = keep(inbox, instruct, **about)
    return notice


def render(folder: Path, *, report: bool, video: bool) -> dict[str, str]:
    """Make report, with its pictures, and video of a finished run; a missing wing is told in a line."""
    if not report and not video:
        return {}
    try:
        write = our_part("rendering", "run", "report")
    except InputError as error:
        tell(error)
        return {}
    made: dict[str, str] = write(folder, report=report, video=video)
    return made


def list_made(result: Mapping[str, Any]) -> list[str]:
    """Return a line for each file that people open, and one about who decided."""
    lines = [f"{name}: {result[name]}" for name in ("report", "video") if result.get(name)]
    return [*lines, *([str(result["decided"])] if result.get("decided") else [])]

"""`--live`: the flags of the page that shows a run under way."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any, Literal

from coral.errors import InputError
from coral.plugins import our_part


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

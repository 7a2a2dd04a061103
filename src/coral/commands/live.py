"""`--live`: the flags of the page that shows a run under way."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any, Literal

from coral.errors import InputError
from coral.plugins import our_part


@dataclass(frozen=True, kw_only=True)
class LiveFlags:
    """The flags of the page."""

    live: bool
    port: int
    speed: float
    wait: bool = True
    """Whether the run waits for the first viewer, and the page stays after its end."""

    def check(self) -> None:
        """Check the flags before anything is made.

        Raises:
            InputError: A flag is out of range, or the port is in use.
        """
        if not self.live:
            return
        our_part("live", "run", "--live")
        from coral.web import check_free

        if not self.speed >= 0:
            raise InputError("--live-speed", "", self.speed, "a number of 0 or more")
        check_free(self.port, "--live-port")


def watching(flags: LiveFlags, system: Literal["reef", "contact"], run: Any) -> AbstractContextManager[list[Any]]:
    """Give the observers that show a mission or an episode in a browser; none without `--live`."""
    if not flags.live:
        return nullcontext([])
    made: AbstractContextManager[list[Any]] = our_part("live", "run", "--live")(
        run, system, port=flags.port, speed=flags.speed, wait=flags.wait
    )
    return made

"""`coral desk`: answer a mission's questions in a browser."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from coral.flags import Argument
from coral.foreign_file import read_text
from coral.interrupts import wait_for_interrupt
from coral.terminal import tell
from coral.words import many

TOKEN_KEY = "CORAL_DESK_TOKEN"
TOKEN_BYTES = 1000


@dataclass(frozen=True, kw_only=True)
class Desk:
    """Serve an inbox as a web page on which a person answers the questions of `--advisor desk`; Ctrl-C ends it."""

    inbox: Annotated[Path, Argument(metavar="INBOX")]
    """Folder of questions, the same as for `coral reef run --advisor desk --inbox`; created if it does not exist."""
    port: int = 8765
    """Port to listen on; 0 chooses a free one."""
    host: str = "127.0.0.1"
    """Address to listen on."""
    token_file: Path | None = None
    """File with the token that a browser must send, part of the printed address; by default $CORAL_DESK_TOKEN, or a new
    one. There is no flag for the token itself: other users could read it."""
    json: bool = False
    """Print one JSON object at the end; the address goes to standard error."""

    def __call__(self) -> Mapping[str, Any]:
        from coral.desk.inbox import Inbox
        from coral.desk.server import DeskServer

        token = os.environ.get(TOKEN_KEY, "")
        if self.token_file is not None:
            token = read_text(self.token_file, "the token, alone", TOKEN_BYTES, "--token-file").strip()
        server = DeskServer(Inbox(self.inbox), self.host, self.port, token)
        tell(f"the desk is open at {server.url}")
        with server:
            wait_for_interrupt(f"it shows the questions in {self.inbox}; Ctrl-C closes it")
        return {"inbox": str(self.inbox), "host": self.host, "port": server.access.port, "answered": server.answered}

    def describe(self, result: Mapping[str, Any]) -> str:
        return f"the desk is closed; {many(result['answered'], 'answer')} went into {result['inbox']}"

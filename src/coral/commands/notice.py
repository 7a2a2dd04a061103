"""The notice of a mission for the people who answer its questions."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

from coral.errors import InputError
from coral.plugins import our_part


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

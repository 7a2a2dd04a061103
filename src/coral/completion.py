"""Shell completion of the `coral` command: a script for bash or zsh with all commands and flags, made by tyro."""

from __future__ import annotations

import contextlib
import dataclasses
import importlib
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Union

from coral.errors import InputError

SHELLS = ("bash", "zsh", "fish")


def completion_script(shell: str, commands: Mapping[str, tuple[str, str]]) -> str:
    """Make the script that a shell reads to complete commands and flags.

    Args:
        shell: One of `SHELLS`.
        commands: `module:class` and description of each command by its words, as in `coral.cli`.

    Raises:
        InputError: There is no completion for this shell.
    """
    if shell not in SHELLS:
        raise InputError("--print-completion", "", repr(shell), f"one of {', '.join(SHELLS)}")
    import tyro

    tree = command_tree(commands)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "completion"
        words = ["--tyro-write-completion", shell, str(path)]
        with contextlib.suppress(SystemExit):
            tyro.cli(tree, prog="coral", args=words, config=(tyro.conf.OmitSubcommandPrefixes,))
        return path.read_text(encoding="utf-8")


def command_tree(commands: Mapping[str, tuple[str, str]]) -> Any:
    """Return the type of all commands together, whose groups (`reef`, `contact`) are subcommands with subcommands."""
    import tyro

    groups: dict[str, list[Any]] = {}
    for words, (place, what) in commands.items():
        module, _, kind = place.partition(":")
        command = getattr(importlib.import_module(module), kind)
        group, _, name = words.rpartition(" ")
        named = tyro.conf.subcommand(name=name, prefix_name=False, description=what)
        groups.setdefault(group, []).append(Annotated[command, named])
    top = groups.pop("", [])
    for group, members in groups.items():
        kind_of_group = dataclasses.make_dataclass(group.capitalize(), [("command", _union(members))])
        top.append(Annotated[kind_of_group, tyro.conf.subcommand(name=group, prefix_name=False)])
    return _union(top)


def _union(members: list[Any]) -> Any:
    return Union[tuple(members)]  # noqa: UP007

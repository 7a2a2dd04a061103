"""The `coral` command line: the first words name a command, whose dataclass defines its flags."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

from coral.commands.unread_settings import refuse_unread
from coral.completion import completion_script, completions
from coral.errors import NO_ROOM, InputError, RunError, nearest
from coral.exit_code import ExitCode
from coral.flag_parser import build, scan
from coral.help_page import flag_page, help_page
from coral.interrupts import orderly_termination
from coral.odd_text import encodable, printable
from coral.surface import described, foreign_commands, is_installed, load

COMMANDS = {
    "reef run": ("coral.commands.reef_run:ReefRun", "survey a reef and write a run folder"),
    "reef sail": ("coral.commands.reef_sail:ReefSail", "survey in real time, with a simulated or a real vehicle"),
    "reef bench": ("coral.commands.reef_bench:ReefBench", "compare variants over many missions, with tables"),
    "reef envs": ("coral.commands.reef_envs:ReefEnvs", "list the reefs, and draw previews"),
    "reef picture": ("coral.commands.reef_picture:ReefPicture", "take a colour picture of a reef, in any water"),
    "reef eyes": ("coral.commands.reef_eyes:ReefEyes", "train a network for RGB pictures, or measure one"),
    "reef map": ("coral.commands.reef_map:ReefMap", "make maps and tables for an ecologist from a run or a recording"),
    "reef generate": ("coral.commands.reef_generate:ReefGenerate", "make a new reef from a topology or a polyline"),
    "contact run": ("coral.commands.contact_run:ContactRun", "attempt a contact task and write a run folder"),
    "contact bench": ("coral.commands.contact_bench:ContactBench", "compare variants over many trials, with tables"),
    "contact tasks": ("coral.commands.contact_tasks:ContactTasks", "list the contact tasks, or describe some"),
    "contact export": ("coral.commands.contact_export:ContactExport", "write runs as a data set for learners"),
    "contact poses": ("coral.commands.contact_poses:ContactPoses", "track a task's objects in a camera's pictures"),
    "memory list": ("coral.commands.memory:MemoryList", "list remembered successes of contact tasks"),
    "memory show": ("coral.commands.memory:MemoryShow", "show one of them, with its programs"),
    "memory forget": ("coral.commands.memory:MemoryForget", "forget one of them"),
    "export": ("coral.commands.export:Export", "write a reef run as a ROS 2 bag, an MCAP file or pictures"),
    "replay": ("coral.commands.replay:Replay", "watch a run folder again in a browser"),
    "report": ("coral.commands.replay:Report", "write report.html (and the video) of a run folder again"),
    "desk": ("coral.commands.desk:Desk", "answer a mission's questions in a browser"),
    "gui": ("coral.commands.gui:Gui", "start, watch, answer and compare runs in a browser"),
    "advisor show": ("coral.commands.advisor:AdvisorShow", "print a prompt and write its pictures"),
    "advisor probe": ("coral.commands.advisor:AdvisorProbe", "test what a model's endpoint can do"),
    "config": ("coral.commands.config:ListConfig", "list or explain the configuration of a survey or an attempt"),
    "doctor": ("coral.commands.doctor:Doctor", "check this installation"),
    "version": ("coral.commands.doctor:Version", "print the version"),
}


def commands() -> dict[str, tuple[str, str]]:
    """Return the commands that are installed, `module:class` and description by their words.

    Those of a missing wing are left out; those of other packages are entry points of the group coral.commands.
    """
    return {name: entry for name, entry in COMMANDS.items() if is_installed(entry[0])} | foreign_commands(COMMANDS)


FIRST = {
    "reef run": "coral.reef.world.world_names:world_file",
    "contact run": "coral.contact.scene.task_names:task_path",
}
"""What finds the file that the first word names before the command is imported: a mistyped name is answered at once."""
HELP = ("-h", "--help")


class Command(Protocol):
    """Interface of a command's dataclass, besides its fields."""

    json: bool

    def __call__(self) -> Mapping[str, Any]:
        """Do the work and return the result, which `--json` prints."""

    def describe(self, result: Mapping[str, Any]) -> str:
        """Describe the result for people."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its `ExitCode`."""
    with orderly_termination() as received:
        code = _run(list(sys.argv[1:] if argv is None else argv))
    return ExitCode.SIGNALLED + received[0] if received else code


def _run(words: Sequence[str]) -> int:
    try:
        if not words or words[0] in HELP:
            print(_overview(""))
            return ExitCode.DONE
        if words[0] in ("-V", "--version"):
            words = ["version", *words[1:]]
        if words[0] == "--print-completion":
            print(completion_script("".join(words[1:2])), end="")
            return ExitCode.DONE
        if words[0] == "--complete":
            for word in completions(words[1:], commands()):
                print(word)
            return ExitCode.DONE
        name = _command(words)
        if name is None:
            print(_overview(" ".join(w for w in words if not w.startswith("-"))))
            return ExitCode.DONE
        words = words[len(name.split()) :]
        if any(word in HELP for word in words):
            print(_help(name, words))
            return ExitCode.DONE
        command = _parse(name, words)
        result = command()
        text = json.dumps(result, allow_nan=False, default=str) if command.json else command.describe(result)
        print(encodable(text), flush=True)
        # A command may report failure by its result, which is printed in either case.
        return int(getattr(command, "exit_code", lambda result: ExitCode.DONE)(result))
    except InputError as error:
        return _print_error(error, ExitCode.BAD_INPUT)
    except RunError as error:
        return _print_error(error, ExitCode.FAILED)
    except KeyboardInterrupt as stop:
        return _print_error(str(stop) or "interrupted", ExitCode.INTERRUPTED)
    except BrokenPipeError:
        sys.stderr.close()
        return ExitCode.FAILED
    except OSError as error:
        if error.errno not in NO_ROOM:
            raise
        place = f"{error.filename}: " if error.filename else ""
        what = (error.strerror or "the disk takes no more").lower()
        return _print_error(f"{place}{what}; what was written before can be read", ExitCode.FAILED)


def _print_error(message: object, code: int) -> int:
    """Print one line on standard error, with control characters escaped; return the exit code."""
    print(f"coral: {printable(str(message))}", file=sys.stderr)
    return code


def _command(words: Sequence[str]) -> str | None:
    """Return the name of the command at the beginning of the words; None for the overview of a group of commands."""
    for n in (2, 1):
        name = " ".join(words[:n])
        if name in COMMANDS:
            if not is_installed(COMMANDS[name][0]):
                raise InputError("coral", "", repr(name), "a command of an installed wing: its wing is missing")
            return name
    known = commands()
    found = next((name for n in (2, 1) if (name := " ".join(words[:n])) in known), None)
    if found is not None:
        return found
    group = [name for name in known if name.split()[0] == words[0] and " " in name]
    if group and (len(words) == 1 or words[1] in HELP):
        return None
    tried = " ".join(words[:2]) if group else words[0]
    near = group or [*known, *{name.split()[0] for name in known}]
    raise InputError("coral", "", repr(tried), f"one of: {', '.join(group or known)}{nearest(tried, near)}")


def _place(name: str) -> str:
    return (COMMANDS.get(name) or commands()[name])[0]


def _parse(name: str, words: Sequence[str]) -> Command:
    place = _place(name)
    if name in FIRST and re.fullmatch("[^-:][^:]*", "".join(words[:1])):  # not gen:3, libero:object/0
        load(FIRST[name])(words[0])
    about = described(place)
    given = scan(words, about, name)
    kind = load(place)
    # The file of `--config` is read before the flags, and so are the defaults of a study.
    default = kind.from_file(words) if hasattr(kind, "from_file") else None
    flags = [flag for flag in about.flags if flag.field in given]
    keys = [".".join(flag.field[1:]) if flag.field[0] == "cfg" else flag.name for flag in flags]
    chosen = {flag.name for flag in flags}
    for flag in flags:
        chosen |= {word if flag.positional else f"{flag.name}={word}" for word in given[flag.field][:1]}
    if default is not None:
        from coral.config import changes, to_mapping  # it takes a tenth of a second to import

        changed = changes(to_mapping(default.cfg), to_mapping(type(default.cfg)()))
        keys += [key for key, _ in changed]
        chosen |= {f"--cfg.{key}={value}" for key, value in changed}
    refuse_unread(name, keys, chosen)
    parsed: Command = build(kind, given, about, name, default)
    return parsed


def _help(name: str, words: Sequence[str]) -> str:
    """Return the help of a command, or of the flags that follow `--help`."""
    about = described(_place(name))
    asked = words[min(words.index(word) for word in HELP if word in words) + 1 :]
    return "\n\n".join(flag_page(name, about, word) for word in asked) or help_page(name, about)


def _overview(group: str) -> str:
    known = commands()
    width = max(map(len, known))
    lines = [f"  coral {name:<{width}} {text}" for name, (_, text) in known.items() if name.startswith(group)]
    usage = ["usage: coral COMMAND [flags]; every command has --help and --json"]
    usage += ["       coral --print-completion bash|zsh|fish"]
    return "\n".join([*usage, "", *lines])


if __name__ == "__main__":
    sys.exit(main())

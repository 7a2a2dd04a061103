"""Shell completion: a short script that asks `coral --complete WORDS...` for what may come next."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from coral.errors import InputError
from coral.flags import MANY, Described
from coral.surface import CONFIGURATIONS, described

SCRIPTS = {
    "bash": """\
_coral() {
    local cur="${COMP_WORDS[COMP_CWORD]}"
    mapfile -t COMPREPLY < <("$1" --complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
    [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *. ]] && compopt -o nospace 2>/dev/null
}
complete -o default -F _coral coral
""",
    "zsh": """\
_coral() {
    local -a found
    found=(${(f)"$("${words[1]}" --complete "${(@)words[2,CURRENT]}" 2>/dev/null)"})
    if (( $#found )); then
        compadd -S '' -- ${(M)found:#*.}
        compadd -- ${found:#*.}
    else
        _files
    fi
}
compdef _coral coral
""",
    "fish": """\
complete -c coral -a '(set -l words (commandline -opc); $words[1] --complete $words[2..] (commandline -ct) 2>/dev/null)'
""",
}
"""By shell. A word that ends in a dot is the beginning of a key, after which no space is wanted."""


def completion_script(shell: str) -> str:
    """Return the script that a shell reads to complete commands, names and flags.

    Raises:
        InputError: There is no completion for this shell.
    """
    if shell not in SCRIPTS:
        raise InputError("--print-completion", "", repr(shell), f"one of {', '.join(SCRIPTS)}")
    return SCRIPTS[shell]


def completions(words: Sequence[str], commands: Mapping[str, tuple[str, str]]) -> list[str]:
    """Return what may stand in place of the last of the words after `coral`, which is unfinished or "".

    `commands` has `module:class` and description of each command by its words, as in `coral.cli`.
    """
    *before, last = words or [""]
    name = next((" ".join(before[:n]) for n in (2, 1) if " ".join(before[:n]) in commands), None)
    if name is None:
        heads = [command.split() for command in commands]
        found = [head[len(before)] for head in heads if head[: len(before)] == before and len(head) > len(before)]
        return _starting(last, [*found, "--help"])
    after = before[len(name.split()) :]
    about = described(commands[name][0])
    if name == "config" and len(after) == 1 and after[0] in CONFIGURATIONS and not last.startswith("-"):
        keys = described(CONFIGURATIONS[after[0]][0]).flags
        return _starting(last, _to_next_dot(last, [".".join(flag.field) for flag in keys]))
    if last.startswith("--"):
        spellings = [spelling for flag in about.flags for spelling in flag.spellings]
        return _starting(last, _to_next_dot(last, [*spellings, "--help"]))
    return _starting(last, _names(after, about))


def _names(before: Sequence[str], about: Described) -> tuple[str, ...]:
    """Return the names that the flag before the unfinished word takes, or that an argument takes."""
    by_word = {spelling: flag for flag in about.flags for spelling in flag.spellings}
    arguments = [flag for flag in about.flags if flag.positional]
    left = list(before)
    while left:
        flag = by_word.get(left.pop(0))
        if flag is not None:
            taken = [word for word in left[: len(left) if flag.words == MANY else flag.words] if word[:2] != "--"]
            if len(taken) < flag.words or (flag.words == MANY and len(taken) == len(left)):
                return flag.names
            left = left[len(taken) :]
        elif arguments and arguments[0].words != MANY:
            arguments.pop(0)
    return arguments[0].names if arguments else ()


def _to_next_dot(begun: str, words: Iterable[str]) -> list[str]:
    """Cut the words after the first dot beyond what is typed: hundreds of keys are offered group by group."""
    cut = []
    for word in words:
        dot = word.find(".", len(begun))
        cut.append(word if dot < 0 else word[: dot + 1])
    return cut


def _starting(begun: str, words: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(word for word in words if word.startswith(begun)))

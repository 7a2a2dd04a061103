"""The registry of advisors: one entry each; parsing, suggestions, help and documentation use it."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from coral.advisor.connect import KEYS
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.question import Advisor
from coral.advisor.setting import Mistake, Rule, Setting
from coral.errors import InputError, nearest
from coral.plugins import find_plugins, load_plugin, our_part


@dataclass(frozen=True, kw_only=True)
class AdvisorEntry:
    """One advisor on the command line. To add one, write its file and its entry in `ENTRIES`."""

    form: str
    """Form on the command line: a name, and its arguments after colons."""
    what: str
    """Short description."""
    make: str = ""
    """`module:function` that makes it, imported on demand: (name, rest, `Setting`) to `Advisor`; "" if a wing does."""
    wraps: bool = False
    """Whether it changes the answers of another advisor: NAME:ARGUMENT:INNER."""
    rules: bool = False
    """Whether only rules of the application answer."""
    person: bool = False
    """Whether it may need as much time as a person."""
    plugin: bool = False
    """Whether another package offers it, by an entry point of the group `coral.advisors`."""

    @property
    def name(self) -> str:
        """Return the first word of its form."""
        return self.form.partition(":")[0]

    def fits(self, spec: str) -> bool:
        """Check whether a string has the argument that the form asks for; that of a plugin may be missing."""
        return self.plugin or (bool(spec.partition(":")[2]) if ":" in self.form else ":" not in spec)


ENTRIES = (
    AdvisorEntry(
        form="heuristic",
        what="rules that come with the package, for reefs; no network, no key, no model",
        make="coral.advisor.rules:make_rules",
        rules=True,
    ),
    AdvisorEntry(
        form="recorded",
        what="a vision-language model's recorded answers to the shipped contact tasks",
        make="coral.advisor.replay:make_recorded",
    ),
    *(
        AdvisorEntry(form=f"{provider}:MODEL", what="a provider's model", make="coral.advisor.models:make_provider")
        for provider in KEYS
    ),
    AdvisorEntry(
        form="local:URL#MODEL",
        what="a model on any OpenAI-compatible server: vLLM, Ollama, llama.cpp",
        make="coral.advisor.models:make_local",
    ),
    AdvisorEntry(form="desk", what="a person, or any program that writes a file", person=True),
    AdvisorEntry(form="replay:FILE", what="the answers of an earlier run", make="coral.advisor.replay:make_replay"),
    AdvisorEntry(
        form="in-order:FILE",
        what="the same, also to questions that have changed since: recorded answers in their order",
        make="coral.advisor.replay:make_replay",
    ),
    AdvisorEntry(
        form="sloppy:ERRORS:INNER", what="another advisor that errs: answers that are wrong, or none", wraps=True
    ),
)
OTHER_NAMES = {
    "gemini": "google",
    "claude": "anthropic",
    "gpt": "openai",
    "chatgpt": "openai",
    "ollama": "local:URL#MODEL",
    "vllm": "local:URL#MODEL",
    "llama": "local:URL#MODEL",
    "human": "desk",
    "operator": "desk",
    "rules": "heuristic",
}
"""Beginnings of common other names for providers and advisors."""
_BY_NAME = {entry.name: entry for entry in ENTRIES}
GROUP = "coral.advisors"
"""Group of entry points by which other packages offer advisors."""


def advisor_help(first: str, *, rules: bool = True) -> str:
    """Return the help of a flag that takes an advisor: the command's own sentence, then the forms of our advisors.

    Those of rules are told only where the application has any.
    """
    return f"{first}: {', '.join(entry.form for entry in ENTRIES if rules or not entry.rules)}."


def innermost(spec: str) -> tuple[AdvisorEntry | None, str]:
    """Return entry and string of the advisor inside all wrappers, which really answers; no entry if it names none."""
    spec = spec.strip()
    entry, rest = _split(spec)
    while entry is not None and entry.wraps:
        spec = rest.partition(":")[2].strip()
        entry, rest = _split(spec)
    return entry, spec


def rules_alone(advisor: str) -> bool:
    """Check whether only rules answer, corrupted or not: no model, no person, no recording of either."""
    entry, _ = innermost(advisor)
    return entry is not None and entry.rules


def asks_person(advisor: str) -> bool:
    """Check whether a person may answer, corrupted or not."""
    entry, _ = innermost(advisor)
    return entry is not None and entry.person


def check_advisor(advisor: Any, where: str = "advisor") -> Advisor:
    """Check an advisor that is given as an object.

    Raises:
        InputError: It has no `answer` coroutine, no name, or the name of an advisor of ours, under which records
            would show its work.
    """
    name = getattr(advisor, "name", None)
    if not isinstance(name, str) or not name or not inspect.iscoroutinefunction(getattr(advisor, "answer", None)):
        raise InputError(where, "", repr(advisor), "a string, or an object with a name and a coroutine `answer`")
    if name.partition(":")[0] in _BY_NAME and not type(advisor).__module__.startswith("coral."):
        raise InputError(where, "name", repr(name), "a name that no built-in advisor has")
    given: Advisor = advisor
    return given


def make_advisor(
    spec: str,
    *,
    rules: Mapping[str, Rule],
    rng: np.random.Generator,
    inbox: Path | None = None,
    cfg: ModelCfg | None = None,
    where: str = "--advisor",
    mistakes: Sequence[Mistake] = (),
) -> Advisor:
    """Make the advisor that a string, in one of the forms of `ENTRIES`, names; `where` is the flag, for errors.

    The `rules`, by kind of question functions of its facts, are the application's own, for `heuristic`; the `mistakes`
    its plausible errors, for `sloppy`. `rng` is for advisors with errors, `inbox` the folder of `desk` for its
    questions.

    Raises:
        InputError: The string names no advisor, a file is missing or unreadable, or the environment has no key.
    """
    spec = spec.strip()
    entry, rest = _split(spec)
    if entry is None:
        raise InputError(where, "", repr(spec), _suggest_forms(spec, bool(rules)))

    def inner(text: str) -> Advisor:
        return make_advisor(text, rules=rules, rng=rng, inbox=inbox, cfg=cfg, where=where, mistakes=mistakes)

    model, errors = cfg or ModelCfg(), tuple(mistakes)
    setting = Setting(rules=rules, rng=rng, inbox=inbox, model=model, where=where, inner=inner, mistakes=errors)
    made: Advisor = _maker(entry, where)(entry.name, rest, setting)
    return made


def _maker(entry: AdvisorEntry, where: str) -> Callable[[str, str, Setting], Advisor]:
    """Import the function that makes an advisor."""
    if entry.plugin:
        return load_plugin(find_plugins(GROUP)[entry.name], where)  # type: ignore[no-any-return]
    if not entry.make:
        return our_part(GROUP, entry.name, where)  # type: ignore[no-any-return]
    module, _, function = entry.make.partition(":")
    return getattr(importlib.import_module(module), function)  # type: ignore[no-any-return]


def _split(spec: str) -> tuple[AdvisorEntry | None, str]:
    """Return the named entry and its argument; no entry if the argument is missing or superfluous."""
    name, _, rest = spec.partition(":")
    entry = _BY_NAME.get(name.strip()) or _plugin_entries().get(name.strip())
    return (entry, rest) if entry is not None and entry.fits(spec) else (None, "")


def _plugin_entries() -> dict[str, AdvisorEntry]:
    """Find the advisors of other packages; the names of ours cannot be taken."""
    return {
        name: AdvisorEntry(form=name, what="from another package", make=point.value, plugin=True)
        for name, point in find_plugins(GROUP).items()
        if name not in _BY_NAME
    }


def _suggest_forms(spec: str, rules: bool) -> str:
    """Suggest valid forms for a string that names no advisor."""
    name, colon, rest = spec.partition(":")
    entry = _BY_NAME.get(name)
    if entry is not None and ":" in entry.form and not rest:
        return f"all of {entry.form}"
    others = _plugin_entries()
    ours = [each for each in ENTRIES if rules or not each.rules]
    known_forms = ", ".join([*(each.form for each in ours), *others])
    known = next((other for start, other in OTHER_NAMES.items() if name.lower().startswith(start)), "")
    known = known if rules or known != "heuristic" else ""
    if known in KEYS:
        model = rest if colon else spec
        return f"one of {known_forms} (did you mean '{known}:{model or 'MODEL'}'?)"
    if known:
        return f"one of {known_forms} (did you mean {known!r}?)"
    return f"one of {known_forms}{nearest(name, [*(each.name for each in ours), *others], 0.7)}"

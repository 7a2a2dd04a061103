"""What a plan may say briefly: names for expressions, and stages repeated for several things. It is written out here.

Both replace `{name}` in the plan's texts, before any of them is compiled: the programs are checked as they are written
out, and a plan that was repeated, remembered or repaired has plain stages.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from coral.contact.cost_program.limits import MOST_CHARACTERS
from coral.errors import nearest

MOST_STAGES = 64
"""Of a plan that is written out."""
MOST_NAMES = 32
NAME = re.compile(r"[a-z_]\w{0,30}")
USED = re.compile(r"\{([A-Za-z_]\w*)\}")


def write_out(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return a plan with plain stages: without `let`, and with each `for` repeated.

    `let` gives expressions names, of which a later one may use earlier ones; an entry `{"for": [{name: text}, ...],
    "stages": [...]}` of the stages stands for these stages once for each.

    Raises:
        ValueError: It is none, uses a name that is not given, or grows beyond the limits.
    """
    plan = {**given}
    let = _texts(plan.pop("let", None) or {}, "let")
    stages = plan.get("stages")
    if not isinstance(stages, list) or not (let or any(_repeats(one) for one in stages)):
        return plan
    names: dict[str, str] = {}
    for name, text in let.items():  # what a loop gives is not known yet: it is replaced where the text is used
        names[name] = f"({_replaced(text, names)})"
    written = [_filled(stage, names) for stage in _each(stages, {})]
    for stage in written:
        unknown = sorted({name for text in _strings(stage) for name in USED.findall(text)})
        if unknown:
            known = [*names, *stage[GIVEN]]
            raise ValueError(
                f"stage {stage.get('name')!r} uses {{{unknown[0]}}}{nearest(unknown[0], known)}, "
                f"which neither `let` nor `for` defines; they define {', '.join(known) or 'nothing'}"
            )
    return {**plan, "stages": [{key: value for key, value in stage.items() if key != GIVEN} for stage in written]}


GIVEN = "\0for"
"""Key under which a repeated stage carries what its loops give."""


def _repeats(stage: Any) -> bool:
    return isinstance(stage, Mapping) and "for" in stage


def _each(stages: Sequence[Any], given: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    """Yield the stages in order, loops unrolled, each with what its loops give."""
    count = 0
    for stage in stages:
        if not isinstance(stage, Mapping):
            raise ValueError("each of `stages` is an object")
        for one in _unrolled(stage, given) if _repeats(stage) else [{**stage, GIVEN: given}]:
            count += 1
            if count > MOST_STAGES:
                raise ValueError(f"more than {MOST_STAGES} stages, written out")
            yield one


def _unrolled(loop: Mapping[str, Any], given: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    turns, stages = loop["for"], loop.get("stages")
    if not isinstance(turns, list) or not turns or not isinstance(stages, list) or set(loop) != {"for", "stages"}:
        raise ValueError('a loop is {"for": [{"thing": "red"}, {"thing": "blue"}], "stages": [...]}')
    if any(_repeats(stage) for stage in stages):
        raise ValueError("a loop holds no other loop")
    for turn in turns:
        yield from _each(stages, {**given, **_texts(turn, "for")})


def _texts(given: Any, where: str) -> dict[str, str]:
    if not isinstance(given, Mapping) or len(given) > MOST_NAMES:
        raise ValueError(f"`{where}` maps at most {MOST_NAMES} names to texts")
    for name, text in given.items():
        if not isinstance(name, str) or not NAME.fullmatch(name) or not isinstance(text, str | int | float):
            raise ValueError(f"`{where}`: {str(name)[:40]!r} is no small name with an expression as text")
    return {name: str(text) for name, text in given.items()}


def _filled(stage: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    """Replace the names in all texts of a stage: first those of `let`, then those that its loops give."""

    def fill(value: Any) -> Any:
        if isinstance(value, str):
            return _replaced(_replaced(value, names), stage[GIVEN])
        if isinstance(value, Mapping):
            return {fill(key): fill(one) for key, one in value.items()}
        return value

    return {key: value if key == GIVEN else fill(value) for key, value in stage.items()}


def _replaced(text: str, names: Mapping[str, str]) -> str:
    made = USED.sub(lambda found: names.get(found[1], found[0]), text)
    if len(made) > MOST_CHARACTERS:
        raise ValueError(f"a text has more than {MOST_CHARACTERS} characters, written out")
    return made


def _strings(stage: Mapping[str, Any]) -> Iterator[str]:
    for key, value in stage.items():
        if isinstance(value, str):
            yield value
        elif isinstance(value, Mapping) and key != GIVEN:
            yield from (str(one) for pair in value.items() for one in pair)

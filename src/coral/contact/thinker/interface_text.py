"""The names and functions that a cost may use, as text for a prompt: what many things have is described once."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from coral.contact.cost.context import Quantity, Schema
from coral.contact.cost.schema import hand_quantities, objects_of

FUNCTIONS = (
    "norm(v), dist(a, b), dot, cross, clip(x, low, high), clip01(x), sigmoid(x), near(d, scale) = exp(-(d/scale)^2), "
    "quat_axis(q, 0|1|2) = that axis in the world, quat_rotate(q, v), quat_angle(a, b), and those of np and math"
)
LEGEND = "Read as self.ee_pos and so on, in world axes; [3]: a vector, [4]: a quaternion, w first, ?: true or false:"
LEAST_SHARED = 2
"""Words that descriptions share at least if they are joined; half of the longest, too."""
MIDDLE = 24
"""Characters of what they do not share at most."""
OWNER, THING = "NAME", "THING"
"""What stands for an object and for anything solid."""
Pattern = tuple[str, str, str]
"""What names have in common: the name and its description with the words above in place of names, and its kind."""
Line = tuple[str, str, str]
"""Names with their kinds, their description, and for which things they are there."""


def interface_text(schema: Schema, told: Collection[str] = ()) -> str:
    """Describe the names and functions that a cost may use."""
    objects = objects_of(schema)
    sized = [key.removesuffix("_size") for key in schema if key.endswith("_size")]
    fixed = ["table", *(thing for thing in sized if thing not in objects and f"{thing}_pos" in schema)]
    groups: dict[Pattern, list[tuple[str, str, str]]] = {}
    for key, item in ((key, item) for key, item in schema.items() if key not in told):
        pattern, owner, thing = _pattern_of(key, item, objects, [*objects, *fixed])
        groups.setdefault(pattern, []).append((key, owner, thing))
    several = [f"({OWNER} is one of {', '.join(objects)}.)"] if len(objects) > 1 else []
    lines = _joined([_group_line(pattern, members, objects, schema) for pattern, members in groups.items()])
    shown = [f"- {names}: {text}{where}" for names, text, where in lines]
    return "\n".join([LEGEND, *several, *shown, f"Functions: {FUNCTIONS}."])


def _pattern_of(key: str, item: Quantity, objects: Sequence[str], things: Sequence[str]) -> tuple[Pattern, str, str]:
    """Return what a name has in common with others, the object that it belongs to and the other thing in it, or ""."""
    name, text, owner = key, _brief(item.text), ""
    kind = (
        (f"[{item.size}]" if item.size else "") + ("?" if item.truth else "") + (f" {item.unit}" if item.unit else "")
    )
    felt = next((one for one in things if key in hand_quantities(one)), "")
    if felt:  # of objects and of what does not move alike
        return (*_replaced(name, text, felt, THING), kind), "", felt
    if len(objects) > 1:
        # The longest of these beginnings: `box_lid_pos` is not of `box`.
        owner = max((thing for thing in objects if name.startswith(f"{thing}_")), key=len, default="")
        name, text = _replaced(name, text, owner, OWNER) if owner else (name, text)
    rest = name.removeprefix(f"{OWNER}_") if owner else name
    alone = len(objects) == 1 and rest.startswith(f"{objects[0]}_")
    rest = rest.removeprefix(f"{objects[0]}_") if alone else rest
    thing = next((one for one in sorted(things, key=len, reverse=True) if f"_{one}_" in f"_{rest}"), "")
    if thing:
        name = name[: len(name) - len(rest)] + f"_{rest}".replace(f"_{thing}_", f"_{THING}_", 1)[1:]
        text = _replaced("", text, thing, THING)[1]
    return (name, text, kind), owner, thing


def _replaced(name: str, text: str, thing: str, word: str) -> tuple[str, str]:
    """Put a word in place of a thing's name, in a quantity's name and in its description."""
    text = re.sub(rf"the {thing}\b", word, text)
    return word + name.removeprefix(thing), re.sub(rf"\b{thing}_(?=(pos|quat)\b)", f"{word}_", text)


def _group_line(pattern: Pattern, members: list[tuple[str, str, str]], objects: Sequence[str], schema: Schema) -> Line:
    """Return the line of the names of one pattern: itself where all of them follow from it."""
    name, text, kind = pattern
    keys = [key for key, _, _ in members]
    if len(keys) == 1:
        return f"{keys[0]}{kind}", _brief(schema[keys[0]].text), ""
    owners = {owner for _, owner, _ in members}
    things = list(dict.fromkeys(thing for _, _, thing in members if thing))
    of_each = {owner: {thing for _, one, thing in members if one == owner} - {""} for owner in owners}
    regular = all(of_each[owner] == set(things) - {owner} for owner in owners)
    if not regular or owners not in ({""}, set(objects)):
        return f"{', '.join(keys)}{kind}", text, ""
    own = f" other than {OWNER}" if owners != {""} and set(things) & owners else ""
    return f"{name}{kind}", text, f" ({THING}: {', '.join(things)}{own})" if things else ""


def _brief(text: str) -> str:
    return text.replace(", world axes", "")


def _joined(lines: Sequence[Line]) -> list[Line]:
    """Join neighbours that are there for the same things, or whose descriptions differ in the middle only."""
    joined: list[tuple[list[str], list[str], str]] = []
    for names, text, where in lines:
        if joined and joined[-1][2] == where and _shared([*joined[-1][1], text]) is not None:
            joined[-1][0].append(names)
            joined[-1][1].append(text)
        else:
            joined.append(([names], [text], where))
    found: list[Line] = []
    for neighbours, texts, where in joined:
        line = (", ".join(neighbours), _shared(texts) or texts[0], where)
        if where and found and found[-1][2] == where:
            line = (f"{found[-1][0]}, {line[0]}", f"{found[-1][1]}; {line[1]}", where)
            found.pop()
        found.append(line)
    return found


def _shared(texts: Sequence[str]) -> str | None:
    """Return descriptions as one, their beginning and end said once; None if they share too little."""
    words = [text.split() for text in texts]
    least = min(len(each) for each in words)
    first = next((k for k in range(least) if len({each[k] for each in words}) > 1), least)
    last = next((k for k in range(least - first) if len({each[-1 - k] for each in words}) > 1), least - first)
    middles = [" ".join(each[first : len(each) - last]) for each in words]
    torn = any(middle.split()[-1:] in ([], ["since"], ["when"]) or len(middle) > MIDDLE for middle in middles)
    if len(texts) == 1 or first + last < max(LEAST_SHARED, max(map(len, words)) / 2) or torn:
        return None
    tail = words[0][len(words[0]) - last :]
    return " ".join([*words[0][:first], ", ".join(middles), *tail])

"""What the classes of a network are to us, by their whole names."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from dataclasses import dataclass

from coral.errors import InputError, nearest
from coral.reef.world.geometry import Label

OYSTERS = {
    *("oyster", "oysters", "live oyster", "live oysters", "living oyster", "living oysters", "oyster cluster"),
    *("oyster clusters", "oyster clump", "oyster reef", "oyster bed", "eastern oyster", "pacific oyster"),
    *("flat oyster", "european oyster", "native oyster", "olympia oyster", "crassostrea virginica"),
    *("crassostrea gigas", "magallana gigas", "ostrea edulis", "ostrea lurida"),
}
"""Names of living oysters. An oyster drill is a snail, an oyster toadfish a fish, a dead oyster a shell."""
FLOOR = {"seabed", "sea bed", "sea floor", "seafloor", "sand", "mud", "sediment", "bottom", "background"} | {
    *("unlabeled", "unlabelled")
}
WATER = {"water", "water column"}
"""Names of what is no object. Whatever has another name is an obstacle: a water bottle, too."""
STATED = {label.name.lower(): label for label in Label}
"""What a user may say that a class is."""


@dataclass(frozen=True)
class ClassTable:
    """The classes of a network."""

    names: Mapping[int, str]
    labels: Mapping[int, Label]

    def describe(self) -> str:
        """Return the table in one line."""
        return "; ".join(f"{key} {self.names[key]}: {label.name.lower()}" for key, label in self.labels.items())


def class_table(names: Mapping[int, str], stated: Mapping[int | str, str], path: str) -> ClassTable:
    """Return what each class is: as the user states (`STATED`), by number or name, or else by its name as a whole.

    Raises:
        InputError: None is an oyster, or something is stated of a class that the network has not.
    """
    numbers = names or {key: str(key) for key in stated if isinstance(key, int)}
    plain = {key: plain_name(name) for key, name in numbers.items()}
    said: dict[int, Label] = {}
    for key, label in stated.items():
        of = [k for k, name in plain.items() if k == key or (isinstance(key, str) and name == plain_name(key))]
        if not of:
            known = list(numbers.values())
            expected = f"one of {', '.join(known) or 'their numbers'}{nearest(str(key), known)}"
            raise InputError(path, f"classes.{key}", "no such class", expected)
        said |= dict.fromkeys(of, STATED[label])
    labels = {key: said.get(key, _by_name(name)) for key, name in plain.items()}
    if Label.OYSTER not in labels.values():
        raise InputError(
            path, "metadata.names", ", ".join(numbers.values()) or "none",
            f"a class that NAME.eyes.yaml states to be an oyster, or named as one of {', '.join(sorted(OYSTERS))}",
        )  # fmt: skip
    return ClassTable(numbers, labels)


def plain_name(name: str) -> str:
    """Return a name in small letters, its words parted by spaces."""
    return " ".join(re.split(r"[\s_-]+", name.strip().lower()))


def read_names(names: str, path: str) -> dict[int, str]:
    """Read the names of classes in a file's metadata: {0: 'oyster', 1: 'rock'}.

    Raises:
        InputError: They are no such text.
    """
    try:
        return {int(key): str(name) for key, name in dict(ast.literal_eval(names)).items()}
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        raise InputError(path, "metadata.names", repr(names[:60]), "names by number, such as {0: 'oyster'}") from None


def _by_name(name: str) -> Label:
    if name in OYSTERS:
        return Label.OYSTER
    return Label.SEABED if name in FLOOR else Label.WATER if name in WATER else Label.OBSTACLE

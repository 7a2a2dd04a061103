"""Who reads a configuration: the fields of its dataclasses are watched while a command runs."""

import contextlib
import dataclasses
import sys
from collections import defaultdict

IGNORED = ("dataclasses", "copy", "pickle", "pydantic", "coral.config", "coral.flag", "coral.commands.config_flag")
"""Modules whose reads copy, check or write a configuration, and use no value of it."""


class Reads:
    """Dotted keys of the user's configuration and the modules that read them."""

    def __init__(self):
        self.by_key = defaultdict(set)
        self.overwritten = set()
        """Keys whose values were replaced by others before anything read them."""
        self._origins = {}
        self._kept = []
        self._copies = {}
        self._known = []
        """All keys of the user's configuration."""

    def follow(self, cfg, prefix=""):
        """Take an object, and those in it, for the user's."""
        self._known += [f"{prefix}{field.name}" for field in dataclasses.fields(cfg)]
        self._own(cfg, {field.name: f"{prefix}{field.name}" for field in dataclasses.fields(cfg)})
        for field in dataclasses.fields(cfg):
            value = object.__getattribute__(cfg, field.name)
            if dataclasses.is_dataclass(value):
                self.follow(value, f"{prefix}{field.name}.")

    def _own(self, cfg, keys):
        self._origins[id(cfg)] = keys
        self._kept.append(cfg)  # no other object gets its id

    def seen(self, cfg, name, frame):
        key = self._origins.get(id(cfg), {}).get(name)
        if key is None:
            return
        if frame.f_code is dataclasses.replace.__code__:
            self._copies.setdefault(id(frame), {})[name] = key
        module, code = frame.f_globals.get("__name__", ""), frame.f_code
        if code.co_name == "_astuple_inner":
            self.by_key[key].add("dataclasses.astuple")
        if not module.startswith(IGNORED) and code.co_name != "__post_init__" and code.co_filename != "<string>":
            self.by_key[key].add(module)

    def made(self, cfg, frame):
        """Take a changed copy for the user's, but for the fields that were changed."""
        if frame.f_code is dataclasses.replace.__code__:
            kept = self._copies.pop(id(frame), {})
            for name, key in self._origins.get(id(frame.f_locals["obj"]), {}).items():
                if name not in kept:
                    new = object.__getattribute__(cfg, name)
                    self._overwrite(key, new)
            self._own(cfg, kept)

    def _overwrite(self, key, new):
        """Take all keys of a part for overwritten that is neither the user's nor a changed copy of the user's."""
        if id(new) not in self._origins or not dataclasses.is_dataclass(new):
            self.overwritten |= {k for k in self._known if k == key or k.startswith(f"{key}.")} - set(self.by_key)


def classes_of(cfg):
    """All classes of a configuration."""
    found = {type(cfg)}
    for field in dataclasses.fields(cfg):
        value = getattr(cfg, field.name)
        if dataclasses.is_dataclass(value):
            found |= classes_of(value)
    return found


def keys_of(cfg, prefix=""):
    """All dotted keys of a configuration."""
    for field in dataclasses.fields(cfg):
        value = getattr(cfg, field.name)
        if dataclasses.is_dataclass(value):
            yield from keys_of(value, f"{prefix}{field.name}.")
        else:
            yield f"{prefix}{field.name}"


@contextlib.contextmanager
def watched(cfg):
    """Watch the fields of a configuration and of all changed copies of it."""
    reads, kinds = Reads(), classes_of(cfg)
    reads.follow(cfg)
    originals = {kind: kind.__init__ for kind in kinds}

    def hook(kind):
        names = {field.name for field in dataclasses.fields(kind)}
        original = originals[kind]

        def read(self, name):
            if name in names:
                reads.seen(self, name, sys._getframe(1))
            return object.__getattribute__(self, name)

        def make(self, *args, **values):
            original(self, *args, **values)
            reads.made(self, sys._getframe(1))

        kind.__getattribute__, kind.__init__ = read, make

    for kind in kinds:
        hook(kind)
    try:
        yield reads
    finally:
        for kind in kinds:
            del kind.__getattribute__
            kind.__init__ = originals[kind]

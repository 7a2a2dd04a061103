"""Compiled kernels on disk: kept where only the user writes, and thrown away when damaged.

numba's index is a pickle: who writes it runs code as whoever reads it, and a truncated one ends every command.
"""

from __future__ import annotations

import contextlib
import importlib.abc
import importlib.util
import os
import stat
import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType
from typing import Any

VARIABLE = "NUMBA_CACHE_DIR"
_CACHING = "numba.core.caching"


def guard_kernel_cache() -> None:
    """Choose a private folder if the default, beside the code, is not private; watch for numba's import."""
    chosen = os.environ.get(VARIABLE)
    if not is_private(Path(chosen) if chosen else Path(__file__).parent):
        os.environ[VARIABLE] = str(_own_folder())
        if chosen:
            print(f"coral: {VARIABLE}={chosen} can be written by others; it is left alone", file=sys.stderr)
    if _CACHING in sys.modules:
        _forgive(sys.modules[_CACHING])
    else:
        sys.meta_path.insert(0, _Watch())


def is_private(folder: Path) -> bool:
    """Check whether nobody but this user and root can write a folder, or make it if it does not exist."""
    try:
        about = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists()).stat()
    except (OSError, StopIteration):
        return False
    mine = about.st_uid in (getattr(os, "geteuid", lambda: about.st_uid)(), 0)
    return mine and not about.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def _own_folder() -> Path:
    root = os.environ.get("XDG_CACHE_HOME")
    folder = (Path(root) if root else Path.home() / ".cache") / "coral" / "kernels"
    with contextlib.suppress(OSError):
        folder.mkdir(0o700, parents=True, exist_ok=True)
        if is_private(folder):
            return folder
    import tempfile

    return Path(tempfile.mkdtemp(prefix="coral-kernels-"))


class _Watch(importlib.abc.MetaPathFinder):
    """Changes numba's cache as it is imported: `import coral` itself must not import numba."""

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        if name != _CACHING:
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(name)
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def and_forgive(module: ModuleType) -> None:
                execute(module)
                _forgive(module)

            spec.loader.exec_module = and_forgive  # type: ignore[method-assign]
        return spec


def _forgive(caching: Any) -> None:
    """Make a damaged index or kernel a line and a new compilation."""
    kind = caching.IndexDataCacheFile
    for name in ("load", "save"):
        setattr(kind, name, _discarding(getattr(kind, name)))


def _discarding(method: Callable[..., Any]) -> Callable[..., Any]:
    def call(self: Any, *args: Any) -> Any:
        try:
            return method(self, *args)
        except OSError:
            raise
        except Exception as error:  # what unpickling damaged bytes raises
            print(f"coral: {self._index_path}: a damaged cache ({type(error).__name__}), made anew", file=sys.stderr)
            with contextlib.suppress(OSError):
                os.unlink(self._index_path)
            return method(self, *args)

    return call

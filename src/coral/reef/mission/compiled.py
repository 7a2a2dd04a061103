"""Whether the kernels of a mission were compiled before: the first one after an installation takes a minute more."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from coral.reef.drive.controller_kernels import rollout

NOTICE = "compiling once, about a minute"


def is_compiled(kernel: Any = rollout) -> bool:
    """Check whether numba's cache has a kernel, by default the one that takes longest, of the present source.

    True also where nobody can tell, as with numba's compiler switched off.
    """
    cache = getattr(getattr(kernel, "_cache", None), "cache_path", None)
    if cache is None:
        return True
    code = kernel.py_func.__code__
    source = Path(code.co_filename)
    index = sorted(Path(cache).glob(f"{source.stem}.{code.co_name}-{code.co_firstlineno}.*.nbi"))
    return any(one.stat().st_mtime >= source.stat().st_mtime for one in index)

"""Whether kernels are in numba's cache."""

import os
from types import SimpleNamespace

from coral.reef.drive.controller_kernels import rollout
from coral.reef.mission.compiled import is_compiled


def test_a_kernel_is_compiled_once_its_index_is_newer_than_its_source(tmp_path):
    source = tmp_path / "kernels.py"
    source.write_text("def add(a):\n    return a + 1\n")
    names = {}
    exec(compile(source.read_text(), str(source), "exec"), names)
    cache = tmp_path / "cache"
    cache.mkdir()
    kernel = SimpleNamespace(py_func=names["add"], _cache=SimpleNamespace(cache_path=str(cache)))
    assert not is_compiled(kernel)
    index = cache / "kernels.add-1.py311.nbi"
    index.write_bytes(b"")
    assert is_compiled(kernel)
    os.utime(index, (1.0, 1.0))
    assert not is_compiled(kernel)


def test_numba_names_its_index_so():
    line = rollout.py_func.__code__.co_firstlineno
    assert rollout._cache._cache_file._index_name.startswith(f"controller_kernels.rollout-{line}.")


def test_where_nobody_can_tell_nothing_is_said():
    assert is_compiled(lambda: None)

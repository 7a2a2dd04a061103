import subprocess
import sys

import pytest

from coral.kernel_cache import is_private

KERNEL = """
import coral, numba
@numba.njit(cache=True)
def twice(x):
    return 2 * x
print(twice(21))
"""


@pytest.mark.slow
@pytest.mark.parametrize(("suffix", "keep"), [("nbi", 0), ("nbc", 0.5)])
def test_a_truncated_cache_is_one_line_and_made_anew(tmp_path, monkeypatch, suffix, keep):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    (tmp_path / "kernel.py").write_text(KERNEL)

    def run():
        done = subprocess.run([sys.executable, tmp_path / "kernel.py"], capture_output=True, text=True, check=True)
        return done.stdout, done.stderr

    assert run() == ("42\n", "")
    (damaged,) = (tmp_path / "cache").rglob(f"*.{suffix}")
    content = damaged.read_bytes()
    damaged.write_bytes(content[: int(len(content) * keep)])
    told, lines = run()
    assert told == "42\n"
    assert lines.count("\n") == lines.count("a damaged cache") == 1
    assert run() == ("42\n", "")


def test_a_folder_that_others_can_write_is_not_used(tmp_path, monkeypatch):
    shared = tmp_path / "shared"
    shared.mkdir()
    assert is_private(shared)
    assert is_private(shared / "new" / "one")
    shared.chmod(0o777)
    assert not is_private(shared)
    assert not is_private(shared / "new")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(shared))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "mine"))
    done = subprocess.run(
        [sys.executable, "-c", "import coral, os; print(os.environ['NUMBA_CACHE_DIR'])"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == f"{tmp_path / 'mine' / 'coral' / 'kernels'}\n"
    assert "can be written by others" in done.stderr
    assert (tmp_path / "mine" / "coral" / "kernels").stat().st_mode & 0o777 == 0o700

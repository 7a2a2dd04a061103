"""Run the tests of the spine with each wing taken off in turn: `make wings`, or `python tests/spine_tests.py WING...`.

A test belongs to the spine if neither its folder is a wing's nor its text names a module of one that is off.
"""

import os
import re
import subprocess
import sys
import tempfile

from wings import ROOT, copy_without, wings

TESTS = ROOT / "tests"


def tests_without(name):
    """Return the test files that remain when a wing is off."""
    listed = wings()
    off = [module.replace(".", "/").removeprefix("coral/") for module in listed[name][0]]
    needing = [other for other in listed if name in page_of(other)]
    off += [module.replace(".", "/").removeprefix("coral/") for other in needing for module in listed[other][0]]
    named = re.compile("|".join(re.escape(each) for path in off for each in (path.replace("/", "."), f"{path}.py")))
    kept = []
    for path in sorted(TESTS.rglob("test_*.py")):
        inside = str(path.relative_to(TESTS)).removesuffix(".py").replace("test_", "")
        if any(inside == each or inside.startswith(f"{each}/") for each in off):
            continue
        if inside.split("/")[0] in ("e2e", "model", "benchmarks", "autopilot") or path.parent == TESTS:
            continue
        if not named.search(path.read_text(encoding="utf-8")):
            kept.append(path)
    return kept


def page_of(name):
    """Return the docstring of a wing's package, which says what it needs."""
    return (ROOT / "src" / name.replace(".", "/") / "__init__.py").read_text(encoding="utf-8").split('"""')[1]


def main(names):
    """Run them, and print a line for each wing."""
    failed = []
    for name in names or wings():
        with tempfile.TemporaryDirectory() as folder:
            copy_without([name], folder)
            environment = {**os.environ, "PYTHONPATH": folder}
            command = [sys.executable, "-m", "pytest", "-q", "-n", "2", *map(str, tests_without(name))]
            done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
        print(f"{name}: {done.stdout.rstrip().splitlines()[-1]}", flush=True)
        failed += [
            f"without {name}: {line}" for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))
        ]
    print("\n".join(failed))
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""Run the tests of the spine with each wing taken off in turn: `make wings`, or `python tests/spine_tests.py WING...`.

A test is the spine's if it lies in no wing's folder. It is left out if its text names a module of the wing that is off,
or of one that needs it: such a test shows how the two work together.
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
    needing = {name} | {other for other in listed if f"`{name}`" in page_of(other)}
    off = [path for one in needing for path in paths(listed[one])]
    words = "|".join(re.escape(each) for path in off for each in (path.replace("/", "."), f"{path}.py"))
    named = re.compile(rf"\b(?:{words})\b")
    folders = [path for wing in listed.values() for path in paths(wing)]
    kept = []
    for path in sorted(TESTS.rglob("test_*.py")):
        inside = str(path.relative_to(TESTS)).removesuffix(".py").replace("test_", "")
        if any(inside == each or inside.startswith(f"{each}/") for each in folders):
            continue
        if inside.split("/")[0] in ("e2e", "model", "benchmarks", "autopilot") or path.parent == TESTS:
            continue
        if not named.search(path.read_text(encoding="utf-8")):
            kept.append(path)
    return kept


def paths(wing):
    """Return where the modules of a wing are, below the package."""
    return [module.replace(".", "/").removeprefix("coral/") for module in wing[0]]


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
            command = [sys.executable, "-m", "pytest", "-n", "2", *map(str, tests_without(name))]
            done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
        print(f"{name}: {done.stdout.rstrip().splitlines()[-1]}", flush=True)
        failed += [
            f"without {name}: {line}" for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))
        ]
    print("\n".join(failed))
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

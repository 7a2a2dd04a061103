"""From a dive to a map: pictures with poses, seen by the shipped network, become a map and tables for an ecologist."""

import sys
from pathlib import Path

from coral.cli import main

out = Path(sys.argv[1] if len(sys.argv) > 1 else "build/examples") / "dive"


def command(*words: object) -> None:
    """Run a command of CORAL in this process."""
    if code := main([str(word) for word in words]):
        sys.exit(code)


command("reef", "run", "s1", "--quiet", "--cfg.simulator.pictures", "--cfg.time-limit-s", 3, "--out", out / "run")
command("export", out / "run", "--to", "pictures", "--out", out / "pictures")
command("reef", "map", out / "pictures", "--perception", "rgb", "--out", out / "map")
print(f"open {out / 'map' / 'products.html'}")

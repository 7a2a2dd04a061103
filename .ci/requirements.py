"""Print what pyproject.toml requires, with the named extras: pip takes hashes for packages, not for this folder.

Usage: python .ci/requirements.py [EXTRA]... >requirements.txt
"""

import sys
import tomllib
from pathlib import Path

project = tomllib.loads((Path(__file__).parent.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]
print(*project["dependencies"], sep="\n")
for extra in sys.argv[1:]:
    print(*project["optional-dependencies"][extra], sep="\n")

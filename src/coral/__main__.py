"""Entry point of `python -m coral`: the `coral` command."""

from __future__ import annotations

import sys

from coral.cli import main

if __name__ == "__main__":
    sys.exit(main())

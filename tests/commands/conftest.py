"""Lets the tests of commands use what the tests of the contact half stage trials with."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "contact"))

"""Lets the tests of commands use what the tests of the contact half stage trials with, and the stub of a model."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "contact"))
sys.path.insert(0, str(Path(__file__).parents[1] / "advisor"))

"""Lets the tests of the contact half share what they stage trials with."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

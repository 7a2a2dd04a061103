"""The texts of the reference, which stand beside what builds its pages."""

import importlib
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "docs" / "site"))
texts = importlib.import_module("reference_texts")

"""The picture of docs/reference/underwater-pictures.md.

Usage: python docs/figures/underwater.py
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

IMAGES = Path(__file__).parents[1] / "images"


def draw_waters() -> None:
    """Write the contact sheet of waters, with the command of the page."""
    out = IMAGES / "underwater-waters.png"
    out.unlink(missing_ok=True)
    waters = ["clear", "jerlov-1C", "bay", "hard"]
    command = ["reef", "picture", "s1", "--at", "6", "5.3", "0", "--size", "320", "240", "--water", *waters]
    subprocess.run([sys.executable, "-m", "coral", *command, "--out", str(out)], check=True)


if __name__ == "__main__":
    draw_waters()

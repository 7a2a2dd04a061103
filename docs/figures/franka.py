"""Make docs/images/franka-pick.png: the simulated Franka arm picks up a box.

Run it from the repository: .venv/bin/python docs/figures/franka.py [RUN_FOLDER]. Without a folder it makes the run
first (20 s on a quiet machine; needs the extras franka and franka-sim, and does nothing without them).
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

IMAGE = Path(__file__).parent.parent / "images" / "franka-pick.png"
RUN = "contact run pick-box --world franka --robot sim --yes --seed 1 --samples 60 --quiet"
"""With the latency of the benchmark besides."""
LATENCY = "--cfg.planning.latency fixed:0.12"


def draw(folder: Path) -> None:
    """Draw heights, opening and force over the arm's clock."""
    rows = np.genfromtxt(folder / "trajectory.csv", delimiter=",", names=True)
    t = rows["t"]
    figure, axes = plt.subplots(3, 1, figsize=(9, 6), sharex=True, layout="constrained")
    axes[0].plot(t, 100 * rows["cmd_z"], color="#9aa5b1", label="tool, commanded")
    axes[0].plot(t, 100 * rows["z"], color="#1f5fa8", label="tool")
    axes[0].plot(t, 100 * rows["box_z"], color="#c2571a", label="box, true")
    axes[0].set_ylabel("height, cm")
    axes[1].plot(t, 1000 * np.clip(rows["cmd_opening"], 0, None), color="#9aa5b1", label="commanded")
    axes[1].plot(t, 1000 * rows["opening"], color="#1f5fa8", label="measured")
    axes[1].set_ylabel("opening, mm")
    axes[2].plot(t, np.sqrt(rows["fx"] ** 2 + rows["fy"] ** 2 + rows["fz"] ** 2), color="#1f5fa8", label="measured")
    axes[2].axhline(30.0, color="#9aa5b1", linestyle="--", label="the pull yields")
    axes[2].axhline(45.0, color="#b3261e", linestyle="--", label="the arm stops")
    axes[2].set_ylabel("contact force, N")
    axes[2].set_xlabel("arm's clock, s")
    for one in axes:
        one.grid(alpha=0.3)
        one.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    figure.savefig(IMAGE, dpi=110)


def main() -> None:
    """Run if needed, and draw."""
    if len(sys.argv) > 1:
        draw(Path(sys.argv[1]))
    elif importlib.util.find_spec("franky_sim") is None:
        print("without the extra franka-sim docs/images/franka-pick.png stays as it is")
    else:
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "run"
            subprocess.run(
                [Path(sys.executable).with_name("coral"), *RUN.split(), *LATENCY.split(), "--out", out], check=True
            )
            draw(out)


if __name__ == "__main__":
    main()

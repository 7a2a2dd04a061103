"""Success, and time to it, over the time of a plan: a figure from campaigns with different numbers of rehearsals.

    python benchmarks/plan_time.py CURVES ... --out FIGURE

Each of CURVES has a folder of `coral contact bench` for each number of rehearsals and sampler, named fine-40, equal-40
and so on; docs/results/contact-realtime.md has the commands. Failures count with the time at which they ended.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import matplotlib as mpl
import pyarrow.parquet as pq

SAMPLERS = {"fine": ("fine samples", "#0b6470"), "equal": ("equal noise, as in the paper", "#d6342c")}
CHARGED_MS = {12: 15, 24: 25, 40: 40, 80: 75, 200: 170}
"""Rehearsals, and the time that a plan with them takes on two quiet cores."""


def main() -> None:
    """Draw the figure, and print its points."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("curves", type=Path, nargs="+")
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.2), layout="constrained")
    print("| sampler | rehearsals | charged | successes | mean time |\n|---|---:|---:|---:|---:|")
    for name, (label, color) in SAMPLERS.items():
        rows = []
        for samples, charged in CHARGED_MS.items():
            tables = [pq.read_table(folder / f"{name}-{samples}" / "results.parquet") for folder in args.curves]
            trials = [trial for table in tables for trial in table.to_pylist()]
            good, mean_s = sum(t["success"] for t in trials), sum(t["sim_time_s"] for t in trials) / len(trials)
            rows.append((charged, 100 * good / len(trials), mean_s))
            print(f"| {label} | {samples} | {charged} ms | {good} of {len(trials)} | {mean_s:.1f} s |")
        charges, success, times = zip(*rows, strict=True)
        left.plot(charges, success, "o-", color=color, label=label)
        right.plot(charges, times, "o-", color=color, label=label)
    left.set(ylabel="success (%)", ylim=(0, 105))
    right.set(ylabel="time, failures to their end (s)")
    right.set_ylim(bottom=0, top=1.15 * right.get_ylim()[1])
    for pane in (left, right):
        pane.set(xlabel="time of a plan, charged (ms)", xscale="log")
        pane.set_xticks(list(CHARGED_MS.values()), [f"{ms}\nK={k}" for k, ms in CHARGED_MS.items()], fontsize=8)
        pane.minorticks_off()
        pane.grid(alpha=0.3)
    left.legend(loc="lower left", fontsize=8)
    figure.savefig(args.out, dpi=120)


if __name__ == "__main__":
    main()

"""Which true clusters a survey at the simulated autopilot has on its map: `python found.py s1 RUN`."""

import sys
from pathlib import Path

import numpy as np

from coral.reef.world.find_world import find_world
from coral.runs import read_events

NEAR_M = 0.3
"""A cluster on the map is a true one if its centre is this near to the circle about it."""


def main(world: str, run: str) -> None:
    """Print how many are found, and how many on the map are none."""
    left = [event for event in read_events(Path(run) / "events.jsonl") if event["event"] == "left"][-1]
    marks = np.array([(dot["x"], dot["y"]) for dot in left["centroids"]]).reshape(-1, 2)
    away = np.full((len(marks), 0), np.inf)
    for cluster in find_world(world).clusters:
        oysters = np.array([(oyster.x, oyster.y) for oyster in cluster.oysters])
        radius = np.hypot(*(oysters - oysters.mean(axis=0)).T).max()
        away = np.column_stack([away, np.hypot(*(marks - oysters.mean(axis=0)).T) - radius])
    near = away <= NEAR_M
    print(f"{near.any(axis=0).sum()} of {near.shape[1]} clusters found, {(~near.any(axis=1)).sum()} false")


if __name__ == "__main__":
    main(*sys.argv[1:])

"""The best pictures of each cluster: those with the most of its oysters, away from the picture's border."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.reef.products.mosaic import colours_of
from coral.reef.products.seen_points import find_points
from coral.reef.recordings.recording import Recording
from coral.reef.world.geometry import Label

EACH, APART_S = 3, 3.0
"""Most pictures of a cluster, and the least time between two of them."""


@dataclass(frozen=True)
class ClusterPicture:
    """A picture chosen for a cluster."""

    cluster: int
    t: float
    x: float
    y: float
    """Where it was taken (m)."""
    pixels: int
    """Pixels that show the cluster's oysters."""
    image: NDArray[np.uint8]
    """Shape=(H, W, 3), red first."""


def best_pictures(recording: Recording, group: NDArray[np.int32]) -> list[ClusterPicture]:
    """Choose up to `EACH` pictures of every cluster of a located recording, the best first.

    `group` is the number of each cell's cluster, from `label_clusters`. Shape=(NY, NX).
    """
    count = int(group.max())
    border = max(1, min(recording.camera.width, recording.camera.height) // 20)
    scores = []
    for keyframe in recording.keyframes():
        points = find_points(keyframe, recording, recording.map.cell_m, (group.shape[0], group.shape[1]))
        inside = np.s_[border:-border, border:-border]
        shown = points.cell[inside][(points.frame.labels[inside] == Label.OYSTER) & (points.cell[inside] >= 0)]
        scores.append((keyframe.t, np.bincount(group.flat[shown], minlength=count + 1)))
    chosen: dict[int, list[tuple[int, int]]] = {}
    for cluster in range(1, count + 1):
        taken: list[int] = []
        for k in sorted(range(len(scores)), key=lambda k: -int(scores[k][1][cluster])):
            if len(taken) == EACH or scores[k][1][cluster] == 0:
                break
            if all(abs(scores[k][0] - scores[other][0]) >= APART_S for other in taken):
                taken.append(k)
        for rank, k in enumerate(taken):
            chosen.setdefault(k, []).append((cluster, rank))
    found: list[tuple[int, int, ClusterPicture]] = []
    for k, keyframe in enumerate(recording.keyframes()):
        for cluster, rank in chosen.get(k, ()):
            pixels = int(scores[k][1][cluster])
            picture = ClusterPicture(
                cluster, keyframe.t, keyframe.pose.x, keyframe.pose.y, pixels, colours_of(keyframe.frame)
            )
            found.append((cluster, rank, picture))
    return [picture for _, _, picture in sorted(found, key=lambda one: one[:2])]

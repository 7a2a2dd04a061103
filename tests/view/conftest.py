"""A small made-up run folder with everything a report shows; killed and empty ones are made from it."""

import json
import math
import shutil

import cv2
import numpy as np
import pytest
import yaml

from coral.reef.pictures.mapview import MapScene, camera_picture, draw_map, png
from coral.reef.world.geometry import Frame, Pose

SIZE = 12.0
CELL = 0.05
CLUSTERS = {"north": (9.0, 9.0), "middle": (6.0, 6.0), "far": (2.0, 10.5)}
COLUMNS = (
    "step,t,x,y,theta,u,v,r,est_x,est_y,est_theta,v_cmd,omega_cmd,goal_x,goal_y,clearance,planner_ok,"
    "coverage,clusters_covered"
)


def world():
    clusters = [
        {
            "name": name,
            "oysters": [
                {"x": x + 0.5 * math.cos(k), "y": y + 0.5 * math.sin(k), "z": 0.05, "radii": [0.12, 0.08, 0.06]}
                for k in range(6)
            ],
        }
        for name, (x, y) in CLUSTERS.items()
    ]
    return {
        "format": "coral-reef/1",
        "name": "made-up <reef>",
        "topology": "S",
        "size_m": [SIZE, SIZE],
        "start": {"x": 2.0, "y": 2.0, "theta": math.pi / 4},
        "clusters": clusters,
        "obstacles": [
            {"shape": "box", "x": 8.0, "y": 4.0, "z": 0.5, "size": [0.6, 0.2, 0.5], "yaw": 0.5},
            {"shape": "cylinder", "x": 4.0, "y": 7.0, "z": 0.5, "size": [0.4, 0.4, 0.5]},
        ],
    }


def cells_at(x, y):
    """Explored along the diagonal up to here, with the clusters and the cylinder that lie in it."""
    n = round(SIZE / CELL)
    gy, gx = (np.mgrid[:n, :n] + 0.5) * CELL
    along = np.clip((gx + gy) / 2, 2.0, (x + y) / 2)
    near = np.hypot(gx - along, gy - along) < 2.5
    cells = near.astype(np.uint8)
    cells[near & (np.hypot(gx - 4.0, gy - 7.0) < 0.4)] = 2
    for cx, cy in CLUSTERS.values():
        cells[near & (np.hypot(gx - cx, gy - cy) < 0.5)] = 3
    return cells


def camera():
    depth = np.tile(np.linspace(9, 0.8, 120, dtype=np.float32)[:, None], (1, 160))
    labels = np.full((120, 160), 3, np.uint8)
    depth[:30], labels[:30] = np.inf, 0
    labels[70:95, 30:60] = 1
    depth[20:80, 110:125], labels[20:80, 110:125] = 2.5, 2
    return Frame(depth, labels, labels.astype(np.int32))


def write_run(folder, seconds=40.0):
    folder.mkdir()
    steps = round(seconds * 10)
    frame = camera()
    rows, events, attempts = [COLUMNS], [], []

    def event(t, kind, **fields):
        events.append({"step": round(t * 10), "t": t, "event": kind, **fields})

    def pose(t):
        return 2.0 + 0.18 * t, 2.0 + 0.18 * t + 0.4 * math.sin(t / 4), math.pi / 4

    for step in range(1, steps + 1):
        t = step / 10
        x, y, theta = pose(t)
        covered = (t > 15) + (t > 33)
        rows.append(
            f"{step},{t},{x:.5f},{y:.5f},{theta:.5f},0.25,0,0,{x:.5f},{y:.5f},{theta:.5f},0.26,0.01,"
            f"{'' if t < 2 else 9.0},{'' if t < 2 else 9.0},{0.2 + abs(math.sin(t / 9)):.4f},1,"
            f"{covered / 3:.5f},{covered}"
        )
    (folder / "frames").mkdir()
    (folder / "pictures").mkdir()
    for step in range(0, steps + 1, 20):
        x, y, _ = pose(step / 10)
        depth = np.where(np.isfinite(frame.depth), frame.depth * 1000, 0).astype(np.uint16)
        for kind, image in (("map", cells_at(x, y)), ("depth", depth), ("labels", frame.labels)):
            cv2.imwrite(str(folder / "frames" / f"{step:06d}_{kind}.png"), image)
    centroids = [{"index": k, "x": x, "y": y, "visited": k == 0} for k, (x, y) in enumerate([(6.0, 6.0), (9.0, 9.0)])]

    def ask(t, decision, attempt, verdict, *, latency=4.0, mode="centroid", answer=None, code="", reason="", raw=""):
        x, y, theta = pose(t)
        scene = MapScene(
            cells=cells_at(x, y),
            cell_m=CELL,
            pose=Pose(x, y, theta),
            centroids=np.array([(c["x"], c["y"]) for c in centroids]),
        )
        shown = {
            "map": draw_map(scene).rgb,
            "segmentation": camera_picture(frame),
            "depth": camera_picture(frame, "depth"),
        }
        digests = []
        for name, rgb in shown.items():
            digests.append(f"{decision}{attempt}{name}")
            (folder / "pictures" / f"{digests[-1]}.png").write_bytes(
                png(np.ascontiguousarray(rgb[::4, ::4]))
            )  # a page encodes each again
        event(t, "question", decision=decision, attempt=attempt, mode=mode, pictures=digests, centroids=centroids)
        if verdict:
            event(
                t + latency,
                "verdict",
                decision=decision,
                attempt=attempt,
                verdict=verdict,
                code=code,
                reason=reason,
                answer=answer,
                asked_at=t,
            )
            attempts.append(
                {
                    "decision": decision,
                    "attempt": attempt,
                    "asked_at_s": t,
                    "answered_at_s": t + latency,
                    "pictures": digests,
                    "captions": [[name, ""] for name in shown],
                    "verdict": verdict,
                    "code": code,
                    "reason": reason,
                    "answer": answer,
                    "raw": raw,
                }
            )

    event(0.0, "start", world="made-up <reef>", advisor="heuristic", variant="full", seed=3, clusters_total=3)
    event(0.0, "trigger", cause="first", fired=True, held_by="")
    event(0.0, "mode", mode="waypoint")
    ask(0.0, 0, 0, "accepted", mode="waypoint", answer={"forward_m": 4, "left_m": -1, "reason": "Along <the> reef."})
    event(4.0, "goal", x=6.0, y=6.0, source="advisor", decision=0, index=None, reason="Along <the> reef.")
    event(12.0, "mode", mode="centroid")
    event(12.0, "trigger", cause="distance", fired=True, held_by="")
    ask(12.0, 1, 0, "malformed", raw='{"selected_centroid_index": two}', code="not-json", reason="Not valid JSON.")
    for k in range(10):
        event(12.5 + k / 10, "trigger", cause="distance", fired=False, held_by="pending")
    event(15.0, "cluster_covered", name="middle", fraction=0.7)
    ask(
        16.0,
        1,
        1,
        "rejected",
        answer={"selected_centroid_index": 0, "reason": "It is near."},
        code="behind-robot",
        reason="The chosen centroid is behind the robot.",
    )
    ask(20.0, 1, 2, "accepted", answer={"selected_centroid_index": 1, "reason": "Unexplored water beyond it."})
    event(24.0, "goal", x=9.0, y=9.0, source="advisor", decision=1, index=1, reason="Unexplored water beyond it.")
    event(26.0, "collision", x=6.7, y=6.8, obstacle=1)
    event(28.0, "monitor", deviation_m=1.2)
    event(33.0, "cluster_covered", name="north", fraction=0.61)
    event(36.0, "trigger", cause="stuck", fired=True, held_by="")
    ask(36.0, 2, 0, "")
    event(seconds, "end", reason="time limit")
    (folder / "events.jsonl").write_text("".join(json.dumps(e) + "\n" for e in events))
    (folder / "attempts.jsonl").write_text("".join(json.dumps(a) + "\n" for a in attempts))
    (folder / "trajectory.csv").write_text("\n".join(rows) + "\n")
    (folder / "world.yaml").write_text(yaml.safe_dump(world()))
    (folder / "config.yaml").write_text(
        yaml.safe_dump(
            {
                "world": "made-up <reef>",
                "advisor": "heuristic",
                "variant": "full",
                "seed": 3,
                "provenance": {"coral": "0.1.0", "commit": "abc123", "machine": "test, 2 cores"},
            }
        )
    )
    (folder / "metrics.json").write_text(
        json.dumps(
            {
                "coverage": 2 / 3,
                "clusters_covered": 2,
                "clusters_total": 3,
                "collisions": 1,
                "advisor_calls": 5,
                "requeries": 2,
                "deviations": 0,
                "steps": steps,
                "sim_time_s": seconds,
                "coverage_time_s": 33.0,
                "distance_m": 10.2,
                "min_clearance_m": 0.2,
                "end_reason": "time limit",
            }
        )
    )
    (folder / "timing.json").write_text(
        json.dumps(
            {
                "wall_time_s": 3.1,
                "control_ms_median": 1.2,
                "control_ms_p99": 4.0,
            }
        )
    )
    return folder


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    """A run that ended; read only."""
    return write_run(tmp_path_factory.mktemp("runs") / "finished")


@pytest.fixture
def fresh(finished, tmp_path):
    """A run that ended, to be changed."""
    return shutil.copytree(finished, tmp_path / "run")


@pytest.fixture
def killed(fresh):
    """A run cut off while it wrote: half lines at the end, no results."""
    for name in ("events.jsonl", "trajectory.csv"):
        text = (fresh / name).read_text()
        (fresh / name).write_text(text[:-9])
    (fresh / "metrics.json").unlink()
    (fresh / "timing.json").unlink()
    return fresh

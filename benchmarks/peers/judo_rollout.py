"""The peer's side of planner.py: judo's own rollout backend on a model and controls from a folder.

Usage: python judo_rollout.py FOLDER REPEATS. Prints one JSON object; writes the last state of each rollout to end.npy.
"""

import importlib.metadata
import json
import sys
import time
from pathlib import Path

import mujoco
import numpy as np
from judo.utils.mj_rollout_backend import MJRolloutBackend
from mujoco.rollout import Rollout


def timed(call, repeats):
    """Medians of wall and CPU time in ms, and what the last call gave."""
    found, result = [], call()
    for _ in range(repeats):
        wall, cpu = time.perf_counter(), time.process_time()
        result = call()
        found.append((time.perf_counter() - wall, time.process_time() - cpu))
    wall, cpu = 1e3 * np.median(found, axis=0)
    return {"wall_ms": float(wall), "cpu_ms": float(cpu)}, result


def main(folder, repeats):
    """Time judo, and beside it MuJoCo's rollout alone in judo's version of MuJoCo."""
    problem = np.load(folder / "problem.npz")
    model = mujoco.MjModel.from_xml_path(str(folder / "model.xml"))
    model.actuator_gainprm[:], model.actuator_biasprm[:] = problem["gainprm"], problem["biasprm"]
    target = model.body("target").id
    model.body_pos[target], model.body_quat[target] = problem["target"][:3], problem["target"][3:]
    initial, ctrl = problem["initial"], problem["ctrl"]
    rows = {}
    backend = MJRolloutBackend(model, len(ctrl))  # one model, one MjData and one thread for each rollout
    rows["judo"], (states, _, _) = timed(lambda: backend.rollout(initial[1:], ctrl), repeats)
    np.save(folder / "end.npy", states[:, -1])
    for threads in (1, 2):
        pool, datas = Rollout(nthread=threads), [mujoco.MjData(model) for _ in range(threads)]
        start = np.tile(initial, (len(ctrl), 1))
        rows[f"mujoco, {threads}"], _ = timed(
            lambda p=pool, d=datas, s=start: p.rollout([model] * len(ctrl), d, s, ctrl), repeats
        )
    print(
        json.dumps(
            {"versions": {name: importlib.metadata.version(name) for name in ("judo-rai", "mujoco")}, "rows": rows}
        )
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))

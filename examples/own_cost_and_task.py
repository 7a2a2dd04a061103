"""A task of your own, as a file, and a cost of your own, as a NumPy function of a batch of states."""

import sys
from pathlib import Path

import numpy as np

import coral

TASK = """
format: coral-contact/1
name: nudge
title: Nudge
instruction: Push the block to the green mark.
time_limit_s: 6
table: {size: [0.8, 0.8, 0.05], center: [0, 0]}
objects:
  - name: block
    parts: [{shape: box, size: [0.06, 0.06, 0.06]}]
    mass_kg: [0.2, 0.4]
    friction: [0.3, 0.5]
    x: [0.0, 0.05]
    y: [-0.02, 0.02]
places: {mark: [0.15, 0, 0.03]}
marks: [{place: mark, color: [0.3, 0.6, 0.35]}]
success:
  hold_s: 0.1
  conditions:
    - {kind: at, object: block, place: mark, tolerance_m: 0.04}
"""


def push(state):
    """Come behind the block as seen from the mark, and bring it there. Shape=(K, H) of each term."""
    to_mark = state.mark_pos - state.block_pos
    behind = state.block_pos - 0.06 * to_mark / np.linalg.norm(to_mark, axis=-1, keepdims=True)
    return {
        "reach": 3.0 * np.linalg.norm(state.ee_pos - behind, axis=-1),
        "push": 10.0 * np.linalg.norm(to_mark[..., :2], axis=-1),
        "closed": state.gripper_target,
    }


out = Path(sys.argv[1] if len(sys.argv) > 1 else "build/examples")
out.mkdir(parents=True, exist_ok=True)
(out / "nudge.yaml").write_text(TASK)
result = coral.run_task(out / "nudge.yaml", cost=push, world="hand", samples=16, poses="ground-truth")
print(result)
print("why it ended:", result.metrics["end_reason"])

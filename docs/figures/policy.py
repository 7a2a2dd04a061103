"""Make policy-sees.png in docs/images: what a served policy is shown at the start of a task.

Run it from the repository: .venv/bin/python docs/figures/policy.py (some seconds; needs robosuite, which `make setup`
installs).
"""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from coral.contact.policy.policy_episode import PolicyCameras
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.panda.world import PandaWorld

IMAGE = Path(__file__).parent.parent / "images" / "policy-sees.png"


def main() -> None:
    """Both pictures, one beside the other."""
    world = PandaWorld(sample_trial(load_task("pick-box"), 0))
    now = world.reset()
    outside, wrist = PolicyCameras(world.model, 224).look(world.data, now.tool)
    gap = np.full((len(outside), 8, 3), 255, np.uint8)
    cv2.imwrite(str(IMAGE), np.concatenate([outside, gap, wrist], axis=1)[..., ::-1])
    world.close()


if __name__ == "__main__":
    main()

"""Rollouts of a hand that comes to a box, as the checks of costs look at."""

import numpy as np
from cost_oracles import make_states

from coral.contact.cost.context import Context


def rolled_out(rng, closest=0.0, thick=0.012):
    """Rollouts of a hand that comes to a 4 cm box on the table; at the distance `closest` the table stops it."""
    k, h = 20, 12
    state = make_states(rng, k, h)
    values = {name: state[name] for name in state.names()}
    box = np.broadcast_to(np.array([0.4, 0.0, 0.02]), (k, h, 3)) + rng.normal(size=(k, 1, 3)) * 0.01
    away = rng.normal(size=(k, 1, 3))
    away[..., 2] = np.abs(away[..., 2]) + 1.0
    away /= np.linalg.norm(away, axis=-1, keepdims=True)
    distance = np.maximum(np.linspace(0.3, 0.0, h)[None, :, None] * rng.uniform(0.7, 1.3, (k, 1, 1)), closest)
    values["box_pos"], values["ee_pos"] = box, box + away * distance
    values["ee_force"] = np.where(distance <= closest, 3.0 * away, 0.0) * np.ones((k, h, 1))
    near = (distance[..., 0] <= 0.03) * np.ones((k, h))
    for part in ("hand", "left", "right"):
        values[f"box_{part}_contact"] = near
    values["gripper_opening"] = rng.uniform(0.0, 0.08, (k, h))
    values["box_size"] = np.array([[[0.04, 0.04, 0.04]]])
    values["board_size"] = np.array([[[0.3, 0.2, thick]]])
    values["board_pos"] = np.broadcast_to(np.array([0.4, 0.3, 0.05]), (k, h, 3))
    return Context(values, (k, h))

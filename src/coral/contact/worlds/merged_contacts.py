"""Contacts of a simulation, merged into one for each pair of named things."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np

from coral.contact.scene.observation import Contact


def merged_contacts(
    model: mujoco.MjModel, data: mujoco.MjData, part_of: Callable[[mujoco.MjModel, int], str]
) -> tuple[Contact, ...]:
    """Merge the contacts of each touching pair into net force and mean point; parts of one name do not count."""
    found: dict[tuple[str, str], list[np.ndarray]] = {}
    wrench = np.zeros(6)
    for k in range(data.ncon):
        contact = data.contact[k]
        if contact.efc_address < 0:
            continue
        names = part_of(model, int(contact.geom[0])), part_of(model, int(contact.geom[1]))
        if names[0] == names[1]:
            continue
        mujoco.mj_contactForce(model, data, k, wrench)
        # The contact frame's x axis points from the first geom to the second: this is the force on the second.
        force = contact.frame.reshape(3, 3).T @ wrench[:3]
        if names[0] > names[1]:
            names, force = (names[1], names[0]), -force
        found.setdefault(names, []).append(np.concatenate([force, contact.pos * abs(wrench[0]), [abs(wrench[0])]]))
    merged = []
    for (first, second), rows in sorted(found.items()):
        total = np.sum(rows, axis=0)
        merged.append(Contact(first, second, total[:3], total[3:6] / max(total[6], 1e-12)))
    return tuple(merged)

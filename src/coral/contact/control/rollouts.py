"""Batched MuJoCo rollouts on several threads; resting objects sleep until something touches them.

A sleeping object costs nearly nothing, and behaves as if it had been awake once it is touched. But sleep is no part of
MuJoCo's state, and an object woken by one rollout would be awake in the thread's next one. So every rollout begins with
a copy of the same data, and neither order nor threads change a result.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco import rollout as mujoco_rollout
from numpy.typing import NDArray

from coral.contact.scene.observation import Array

FULL = int(mujoco.mjtState.mjSTATE_FULLPHYSICS)
SLEEP = int(getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", 0))
"""0 in a MuJoCo without sleep: everything stays awake there."""
MOMENT_S = 1e-9
"""Duration of the step that puts resting objects to sleep: MuJoCo does it at a step's end, and nothing may move."""
NEAR_M = 1e-3
"""An object this close to something lies on it: cameras measure no better."""


@dataclass(frozen=True)
class RolloutStart:
    """Start of all rollouts of a model."""

    model: mujoco.MjModel
    state: Array
    """Shape=(S,), MuJoCo's full physics state."""
    data: mujoco.MjData | None = None
    """Copied at the start of every rollout; None if nothing can sleep, so that the state is sufficient."""

    @classmethod
    def at(cls, model: mujoco.MjModel, state: Array) -> RolloutStart:
        """Start from a state.

        If the model enables sleep, every object sleeps that is slower than its `sleep_tolerance`, lies on something and
        touches nothing that is awake.
        """
        if not model.opt.enableflags & SLEEP:
            return cls(model, state)
        data = mujoco.MjData(model)
        mujoco.mj_setState(model, data, state, FULL)
        with _momentary_step(model):
            mujoco.mj_forward(model, data)
            touching = model.body_treeid[model.geom_bodyid[data.contact.geom.ravel()]]
            data.tree_asleep[touching[touching >= 0]] = -1  # MuJoCo's counter of slow steps at its end
            mujoco.mj_step(model, data)
        state = state.copy()
        sleeping = data.tree_asleep[model.dof_treeid] >= 0
        state[1 + model.nq : 1 + model.nq + model.nv][sleeping] = 0.0
        for joint in np.flatnonzero(sleeping[model.jnt_dofadr]):  # bit for bit: a sleeper that was moved wakes up
            width = 7 if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE else 1
            place = slice(int(model.jnt_qposadr[joint]), int(model.jnt_qposadr[joint]) + width)
            state[1 : 1 + model.nq][place] = data.qpos[place]
        return cls(model, state, data)


@contextmanager
def _momentary_step(model: mujoco.MjModel) -> Iterator[None]:
    """Set a step that takes no time, and count near bodies as touching."""
    kept = model.opt.timestep, model.geom_margin.copy(), model.body_margin.copy()
    model.opt.timestep = MOMENT_S
    model.geom_margin[:] = model.body_margin[:] = NEAR_M
    try:
        yield
    finally:
        model.opt.timestep, model.geom_margin[:], model.body_margin[:] = kept


@dataclass(frozen=True)
class Rolled:
    """Results of a batch of rollouts."""

    states: Array
    """Shape=(N, T, S), full physics states."""
    sensors: Array
    """Sensor data, Shape=(N, T, M)."""
    sane: NDArray[np.bool_]
    """Which rollouts are valid, Shape=(N,)."""


Mend = Callable[[Array, Array], NDArray[np.bool_]]
"""Inspects states and sensors of rollouts, overwrites invalid ones, and returns which are valid."""


class Rollouts:
    """A pool of threads for batches of rollouts; 0 uses every core."""

    can_sleep = bool(SLEEP)
    """Whether resting objects may sleep."""

    def __init__(self, threads: int) -> None:
        self._threads = threads or os.cpu_count() or 1
        self._rollout = mujoco_rollout.Rollout(nthread=0)  # in the calling thread
        self._pool = ThreadPoolExecutor(self._threads)
        self._datas: dict[int, list[mujoco.MjData]] = {}

    def close(self) -> None:
        """Stop the threads."""
        self._pool.shutdown()
        self._rollout.close()

    def run(self, starts: Sequence[RolloutStart], control: Array, spec: int, every: int, mend: Mend) -> Rolled:
        """Roll out every start, of models that differ only in numbers, under its share of the controls.

        These have Shape=(len(starts) * K, T * every, C): the first K for the first start, and so on; `spec` says what
        is in a row, as MuJoCo's `mjtState` bits. Of `every` so many steps the last is kept. `mend` checks a part of the
        rollouts as soon as it is complete.
        """
        total, steps = control.shape[:2]
        each = [start for start in starts for _ in range(total // len(starts))]
        initial = np.array([start.state for start in each])
        found = Rolled(
            column_major(total, steps // every, initial.shape[1]),
            column_major(total, steps // every, starts[0].model.nsensordata),
            np.empty(total, dtype=bool),
        )
        parts = _split_into_slices(total, self._threads)
        todo = iter(parts)

        def work(data: mujoco.MjData) -> None:
            states = np.empty((parts[0].stop, steps, found.states.shape[2]))  # size of the largest part
            sensors = np.empty((*states.shape[:2], found.sensors.shape[2]))
            for part in todo:  # threads share it: an iterator hands out each part once
                for rows in _slices_per_call(each, part):
                    if each[rows.start].data is not None:
                        mujoco.mj_copyData(data, each[rows.start].model, each[rows.start].data)
                    here = slice(rows.start - part.start, rows.stop - part.start)
                    self._rollout.rollout(
                        [start.model for start in each[rows]],
                        [data],
                        initial[rows],
                        control[rows],
                        control_spec=spec,
                        skip_checks=True,
                        nstep=steps,
                        state=states[here],
                        sensordata=sensors[here],
                    )
                kept = slice(part.stop - part.start), slice(every - 1, None, every)
                found.states[part], found.sensors[part] = states[kept], sensors[kept]
                found.sane[part] = mend(found.states[part], found.sensors[part])

        datas = self._thread_data(starts[0].model)
        if total == 1:
            work(datas[0])
        else:
            list(self._pool.map(work, datas))
        return found

    def _thread_data(self, model: mujoco.MjModel) -> list[mujoco.MjData]:
        """Return the threads' MjData for models of this structure."""
        if model.signature not in self._datas:
            self._datas[model.signature] = [mujoco.MjData(model) for _ in range(self._threads)]
        return self._datas[model.signature]


def column_major(*shape: int) -> Array:
    """Allocate an array in column-major order, as costs read it."""
    return np.moveaxis(np.empty((shape[-1], *shape[:-1])), 0, -1)


def _split_into_slices(total: int, threads: int) -> list[slice]:
    """Split into slices of decreasing size, so that no thread waits long for another's last one."""
    found: list[slice] = []
    begin = 0
    while begin < total:
        end = begin + math.ceil((total - begin) / (2 * threads))
        found.append(slice(begin, end))
        begin = end
    return found


def _slices_per_call(each: Sequence[RolloutStart], part: slice) -> Iterator[slice]:
    """Yield the slices that MuJoCo may roll out in one call: single ones if each begins with a copy."""
    if each[part.start].data is None:
        yield part
    else:
        yield from (slice(k, k + 1) for k in range(part.start, part.stop))

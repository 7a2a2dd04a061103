"""Batched rollouts in MuJoCo on several threads; what rests sleeps until something touches it.

A sleeping object costs nearly nothing, and goes on as if it had been awake when it is touched. But what is asleep is no
part of MuJoCo's state, and what one rollout wakes would be awake in the next one on that thread. So every rollout
begins with a copy of the same data, and neither order nor threads change a result.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco import rollout as mujoco_rollout
from numpy.typing import NDArray

Array = NDArray[np.float64]
FULL = int(mujoco.mjtState.mjSTATE_FULLPHYSICS)
SLEEP = int(getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", 0))
"""0 in a MuJoCo that cannot: there everything stays awake."""
MOMENT_S = 1e-9
"""So long is the step in which what rests is put to sleep: MuJoCo does it at the end of one, and nothing shall move."""
NEAR_M = 1e-3
"""What is so near to something lies on it: cameras measure no better."""


@dataclass(frozen=True)
class Start:
    """Where all rollouts of a model begin.

    Args:
        model: What is rolled out.
        state: Shape=(S,), MuJoCo's full physics state.
        data: What every rollout has a copy of; None where nothing can sleep, and the state is all there is.
    """

    model: mujoco.MjModel
    state: Array
    data: mujoco.MjData | None = None

    @classmethod
    def at(cls, model: mujoco.MjModel, state: Array) -> Start:
        """Begin at a state.

        Where the model enables sleep, everything sleeps that is slower than its `sleep_tolerance`, lies on something
        and touches nothing that is awake.
        """
        if not model.opt.enableflags & SLEEP:
            return cls(model, state)
        data = mujoco.MjData(model)
        mujoco.mj_setState(model, data, state, FULL)
        with _for_a_moment(model):
            mujoco.mj_forward(model, data)
            touching = model.body_treeid[model.geom_bodyid[data.contact.geom.ravel()]]
            data.tree_asleep[touching[touching >= 0]] = -1  # MuJoCo counts up to it while a tree is slow
            mujoco.mj_step(model, data)
        state = state.copy()
        sleeping = data.tree_asleep[model.dof_treeid] >= 0
        state[1 + model.nq:1 + model.nq + model.nv][sleeping] = 0.0
        for joint in np.flatnonzero(sleeping[model.jnt_dofadr]):  # to the last bit: a sleeper that was moved wakes up
            place = slice(int(model.jnt_qposadr[joint]), int(model.jnt_qposadr[joint]) + 7)
            state[1:1 + model.nq][place] = data.qpos[place]
        return cls(model, state, data)


@contextmanager
def _for_a_moment(model: mujoco.MjModel) -> Iterator[None]:
    """A step takes no time, and what is near touches."""
    kept = model.opt.timestep, model.geom_margin.copy(), model.body_margin.copy()
    model.opt.timestep = MOMENT_S
    model.geom_margin[:] = model.body_margin[:] = NEAR_M
    try:
        yield
    finally:
        model.opt.timestep, model.geom_margin[:], model.body_margin[:] = kept


class Rollouts:
    """Threads that roll out.

    Args:
        threads: 0 takes every core.
    """

    def __init__(self, threads: int) -> None:
        self._threads = threads or os.cpu_count() or 1
        self._batch = mujoco_rollout.Rollout(nthread=self._threads)
        self._single = mujoco_rollout.Rollout(nthread=0)
        self._pool = ThreadPoolExecutor(self._threads)
        self._datas: dict[int, list[mujoco.MjData]] = {}

    def close(self) -> None:
        """Stop the threads."""
        self._pool.shutdown()
        self._batch.close()
        self._single.close()

    def run(self, starts: Sequence[Start], control: Array, spec: int) -> tuple[Array, Array]:
        """Roll out every start under its share of the controls.

        Args:
            starts: Of models that differ in numbers alone.
            control: Shape=(len(starts) * K, T, C): the first K for the first start, and so on.
            spec: What a row of it sets, as MuJoCo's `mjtState` bits.

        Returns:
            The full physics states, Shape=(len(starts) * K, T, S), and sensor readings, after each step.
        """
        total, steps = control.shape[:2]
        each = [start for start in starts for _ in range(total // len(starts))]
        initial = np.array([start.state for start in each])
        states = np.empty((total, steps, initial.shape[1]))
        sensors = np.empty((total, steps, starts[0].model.nsensordata))
        datas = self._own(starts[0].model)
        if all(start.data is None for start in starts):
            self._batch.rollout([start.model for start in each], datas, initial, control, control_spec=spec,
                                skip_checks=True, nstep=steps, state=states, sensordata=sensors)
            return states, sensors
        todo = iter(range(total))

        def work(data: mujoco.MjData) -> None:
            for k in todo:  # threads share it: an iterator hands out each number once
                mujoco.mj_copyData(data, each[k].model, each[k].data)
                part = slice(k, k + 1)
                self._single.rollout([each[k].model], [data], initial[part], control[part], control_spec=spec,
                                     skip_checks=True, nstep=steps, state=states[part], sensordata=sensors[part])

        list(self._pool.map(work, datas))
        return states, sensors

    def _own(self, model: mujoco.MjModel) -> list[mujoco.MjData]:
        """The threads' data for models of this make."""
        if model.signature not in self._datas:
            self._datas[model.signature] = [mujoco.MjData(model) for _ in range(self._threads)]
        return self._datas[model.signature]

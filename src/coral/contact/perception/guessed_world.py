"""An evaluation world in which object poses are estimated once at the start and never updated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from coral.contact.perception.object_model import from_trial
from coral.contact.perception.symmetry import PoseDifference, compare_poses
from coral.contact.scene.observation import BodyState, HandTarget, Observation, Truth
from coral.contact.scene.trial import Trial
from coral.contact.worlds.evaluation_world import EvaluationWorld, WrappedWorld
from coral.errors import InputError


class GuessedWorld(WrappedWorld):
    """Wraps a world with a simulation, for the picture, and leaves out the tracker (paper, Table 1, last row).

    The trial's shapes and symmetries are used to compare with the truth.

    Raises:
        InputError: The world has no pictures.
    """

    def __init__(self, world: EvaluationWorld, trial: Trial) -> None:
        super().__init__(world)
        if world.simulation is None:
            raise InputError("--variant", "", "poses guessed from a picture", "a world of which pictures can be made")
        model = world.simulation.model
        self._shapes = {name: from_trial(model, trial, name) for name in trial.objects}
        self._guessed: dict[str, BodyState] = {}

    def reset(self) -> Observation:
        """See `RobotWorld.reset`; the observation has no objects until `settle`."""
        self._guessed = {}
        return self._with_guesses(self._world.reset())

    def settle(self, guessed: Mapping[str, BodyState], now: Observation) -> Observation:
        """Set the estimated poses and return the observation with them."""
        self._guessed = dict(guessed)
        return self._with_guesses(now)

    def step(self, target: HandTarget) -> Observation:
        """See `RobotWorld.step`."""
        return self._with_guesses(self._world.step(target))

    def compare(self, now: Observation, truth: Truth) -> dict[str, PoseDifference]:
        """Compute the errors of the estimated poses; for the record only."""
        return {
            name: compare_poses(self._shapes[name].symmetry, now.objects[name], truth.objects[name], lost=False)
            for name in now.objects
        }

    def _with_guesses(self, now: Observation) -> Observation:
        return replace(now, objects=dict(self._guessed))

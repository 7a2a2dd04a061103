"""The bias of a wrench estimate, measured while nothing touches the hand."""

from __future__ import annotations

import numpy as np

from coral.contact.scene.observation import Array


class WrenchBias:
    """Averages readings and subtracts the mean from later ones.

    An arm estimates its wrench from joint torques; friction and an inexact load show as a bias that changes with the
    posture, so it is measured in the start posture, and noise that stays.

    Args:
        readings: Number of readings to average.
    """

    def __init__(self, readings: int) -> None:
        self._needed = readings
        self._readings: list[Array] = []
        self.bias = np.zeros(6)

    @property
    def known(self) -> bool:
        """Whether enough readings were averaged."""
        return len(self._readings) >= self._needed

    def add(self, wrench: Array) -> None:
        """Add a reading, Shape=(6,), of a hand that touches nothing."""
        self._readings.append(np.array(wrench, float))
        if self.known:
            self.bias = np.mean(self._readings, axis=0)

    def corrected(self, wrench: Array) -> Array:
        """Return a reading without the bias, Shape=(6,)."""
        return np.asarray(wrench, float) - self.bias

"""The controller: a planning world, rollouts in it, MPPI over knots, reactive feedback (Eqs. 4 to 7)."""

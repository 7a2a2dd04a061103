"""The Franka Panda as an evaluation world, in robosuite."""

"""A Franka arm as a robot's world: its stream, limits, preflight, and a simulated double that speaks its protocol."""

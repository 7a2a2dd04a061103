"""The robot's side of a mission: the sensor guard, the tick, who is asked when, and the watchdogs."""

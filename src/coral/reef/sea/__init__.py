"""From the pilot to a vehicle: links, the simulated autopilot."""

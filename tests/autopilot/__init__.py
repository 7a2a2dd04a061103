"""A BlueROV2's autopilot that speaks MAVLink as ArduSub does, for tests and benchmarks."""

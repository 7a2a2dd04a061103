"""What stands in for a vehicle at sea: a simulated one in real time, and its sensors.

A wing. It needs `coral.reef.sea`.
"""

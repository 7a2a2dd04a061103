"""Real scenes: cameras, masks, calibration, recordings, and how well a tracker follows known motions.

A wing. Its commands need `coral.contact.franka` to send poses to an arm.
"""

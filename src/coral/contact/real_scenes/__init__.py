"""Real scenes: cameras, masks, calibration, recordings, and how well a tracker follows known motions.

A wing. It needs `coral.ros` for bags, and its commands `coral.contact.franka` to send poses to an arm.
"""

"""Real scenes: cameras and where they stand, masks, tracking of their pictures.

A wing. It needs `coral.ros` for bags, and its commands `coral.contact.franka` to send poses to an arm.
"""

"""Real scenes: cameras, masks, calibration, recordings of objects with known poses, and how well they are tracked.

A wing. Its commands need `coral.view` for the page on which objects are clicked, and `coral.contact.franka` to send
poses to an arm.
"""

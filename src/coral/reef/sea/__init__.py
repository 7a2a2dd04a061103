"""From the pilot to a vehicle in real time: its link, its sensors, what stands round the mission loop there.

A wing. Its commands need `coral.view` for their pages.
"""

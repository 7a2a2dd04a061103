"""What a person takes home from a survey: maps with coordinates, areas with intervals, tables and pictures.

A wing. It needs `coral.reef.recordings`, and its commands `coral.view` for their page.
"""

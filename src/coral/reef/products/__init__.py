"""What a person takes home from a survey: maps with coordinates, areas with intervals, tables and pictures."""

"""The front page: start runs, watch them, answer their questions, open their reports, compare two."""

"""Questions to a foundation model, with verified answers."""

"""Tasks: objects, conditions of success, random trials, and the judge."""

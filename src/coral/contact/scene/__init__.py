"""What is asked: tasks, objects, conditions of success, random trials, and the judge."""

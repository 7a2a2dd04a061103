"""What a cost reads: batches of states under their names, and the stages of a strategy."""

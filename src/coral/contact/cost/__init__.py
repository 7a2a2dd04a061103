"""Inputs of a cost: batches of named states, and the stages of a strategy."""

"""Masses and frictions: estimates, identification from what was felt, corrections."""

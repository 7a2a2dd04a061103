"""Masses and frictions: estimates, identification from contact forces and motion, corrections."""

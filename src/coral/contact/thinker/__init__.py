"""The outer loop: what is asked when, what went wrong, what is repaired (section 3.4)."""

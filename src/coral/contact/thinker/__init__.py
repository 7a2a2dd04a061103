"""The outer loop: which question is asked when, diagnosis and repair (section 3.4)."""

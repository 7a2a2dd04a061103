"""The outer loop: when to ask what, diagnosis and repair (section 3.4)."""

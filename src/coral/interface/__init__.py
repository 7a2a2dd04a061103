"""The Python interface: missions and contact tasks as function calls with results as objects."""

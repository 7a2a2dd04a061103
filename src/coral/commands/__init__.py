"""One file per command: a dataclass of flags, which does the work and describes the result."""

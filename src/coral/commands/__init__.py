"""One command a file: a dataclass of flags that does the work and describes the result."""

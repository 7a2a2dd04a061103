"""Vision-language-action policies that a server elsewhere runs, on the same tasks, in the same worlds."""

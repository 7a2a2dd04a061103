"""Where to go next: candidates, questions, verifiers, trigger, topological memory, advisors without a model."""

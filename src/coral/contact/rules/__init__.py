"""The default advisor: an answer to each kind of question by rules. No language or vision model is asked."""

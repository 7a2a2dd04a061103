"""The stand-in for a language model: an answer to each kind of question by rules, from facts alone.

No part of the paper's pipeline. It lets everything else run, and be tested, where no model is at hand.
"""

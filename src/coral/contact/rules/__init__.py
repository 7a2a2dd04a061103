"""The stand-in for a language model: rules that answer each kind of question from facts alone.

No part of the paper's pipeline. It lets everything else run, and be tested, where no model is at hand.
"""

"""The default advisor: rules that answer each kind of question from facts alone.

It is no part of the paper's pipeline. With it, everything else runs and is tested without a model.
"""

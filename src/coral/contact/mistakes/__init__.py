"""Plausible errors of models, put into right answers by `sloppy`."""

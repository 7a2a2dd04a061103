"""Errors of models put into right answers: plausible ones for `sloppy`, crude ones for `fallible`."""

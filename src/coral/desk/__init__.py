"""The operator's desk: a local web page on which a person answers the questions of an inbox.

A wing. It needs no other.
"""

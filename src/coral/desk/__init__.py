"""The operator's desk: a local web page on which a person answers the questions of an inbox; and the front page.

A wing. The front page needs `coral.view`, whose pages it opens; the rest of it needs no other.
"""

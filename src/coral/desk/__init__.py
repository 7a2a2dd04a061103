"""The operator's desk: a local web page over the inbox in which questions wait for a person's answer."""

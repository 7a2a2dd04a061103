"""The operator's desk: a local web page over the inbox whose questions wait for a person's answer."""

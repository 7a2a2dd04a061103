"""CORAL: a VLM-advised underwater robot surveys oyster reefs it has never seen."""

"""The experience memory (Eq. 1): plans that have succeeded, found again and adapted."""

"""The experience memory (Eq. 1): successful plans, retrieved and adapted."""

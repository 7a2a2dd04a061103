"""Is this model good enough? Frozen questions with scored answers, put to any advisor, no simulation in the loop."""

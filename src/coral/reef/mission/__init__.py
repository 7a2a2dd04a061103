"""A mission from start to end: loop, record, metrics, judge, variants, presets."""

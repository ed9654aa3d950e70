"""A map of two knobs."""

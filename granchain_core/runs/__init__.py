"""Runs: one motion computed to a stated accuracy, its budget, many at once; the live chain."""

"""Runs: one motion computed to a stated accuracy, with a budget; many runs at once; the live chain."""

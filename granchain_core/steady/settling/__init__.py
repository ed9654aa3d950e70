"""Settling: one chain is run to its steady state, and its regime is decided."""

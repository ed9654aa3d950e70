"""Settling one chain: running it to its steady state, and deciding its regime."""

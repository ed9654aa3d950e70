"""Batches: many steady states at once, on all cores."""

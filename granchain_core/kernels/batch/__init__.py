"""Batches: several scenes at once, each a member in its own SIMD lane."""

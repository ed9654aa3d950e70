"""Batches: several scenes at once, each a member in one SIMD lane."""

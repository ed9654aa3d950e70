"""Several scenes at a time, one in each SIMD lane."""

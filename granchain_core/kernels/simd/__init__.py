"""Vectors of doubles as Numba types, functions on them, and the handling of subnormal numbers."""

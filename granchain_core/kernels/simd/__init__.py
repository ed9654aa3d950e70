"""Vectors of doubles as Numba types, functions of them, and subnormal numbers."""

"""Everything Numba compiles: effects, equations, methods."""

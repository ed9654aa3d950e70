"""Compiled code: effects, equations and methods, on floats and arrays; it knows nothing of the rest of the core."""

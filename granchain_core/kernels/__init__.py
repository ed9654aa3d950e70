"""Compiled code: effects, equations and methods, on floats and arrays, independent of the rest of the core."""

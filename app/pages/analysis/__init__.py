"""Spectrum, Lyapunov exponents, bifurcation diagram and basins of the present scene."""

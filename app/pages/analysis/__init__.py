"""Spectrum, Lyapunov exponents, strobes and basins of the present scene (docs/analysis.md)."""

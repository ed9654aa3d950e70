"""Analyses (docs/analysis.md): spectra, rotation number, bifurcation diagram, basins; pulses and pass bands."""

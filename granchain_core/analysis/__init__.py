"""Analyses, a module each: spectrum, Lyapunov spectrum, rotation number, bifurcation diagram, basins, pulses, bands."""

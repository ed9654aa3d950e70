"""Analyses, a module each: spectrum, Lyapunov spectrum, rotation number, strobes over a knob, basins, pulses, bands."""

"""Analysis of a motion: spectrum, Lyapunov spectrum and dimension, strobes over a knob, basins, pulses, pass bands."""

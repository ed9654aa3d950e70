"""What a motion is like: its spectrum, its Lyapunov spectrum and dimension, its strobes over a knob, its basins."""

"""The resonance curve and its sweeps, which are always on the screen and behind no tab."""

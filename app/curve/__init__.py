"""The resonance curve and its sweeps, which are always on screen rather than behind a tab."""

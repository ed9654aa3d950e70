"""The resonance curve and its sweeps: always on the screen, and behind no tab."""

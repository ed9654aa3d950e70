"""The resonance curve and its sweeps: always on the screen, so no page and no tab."""

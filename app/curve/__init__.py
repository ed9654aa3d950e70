"""The resonance curve and its sweeps: always on the screen, so it has no row in the table of pages and no tab."""

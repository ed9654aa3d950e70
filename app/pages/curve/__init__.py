"""The resonance curve and its sweeps."""

"""The resonance curve."""

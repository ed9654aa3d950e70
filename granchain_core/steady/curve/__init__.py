"""The resonance curve, its peaks and valleys."""

"""Steady states of a driven chain: settling, regime, resonance curve."""

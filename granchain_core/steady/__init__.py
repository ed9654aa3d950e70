"""Steady states of a driven chain: settling, batches, the resonance curve; criteria of the regime, errors of forces."""

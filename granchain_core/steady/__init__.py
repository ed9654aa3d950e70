"""What a driven chain does in the end: settling, regime, resonance curve."""

"""How often the 95 % intervals of a fit hold the truth: virtual experiments with known parameters, drawn at random."""

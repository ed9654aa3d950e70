"""How often the 95 % intervals of a fit contain the truth, in virtual experiments with random known parameters."""

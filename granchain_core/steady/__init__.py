"""Steady states of a driven chain: criteria of the regime, Lyapunov exponent, Poincaré section, errors of an orbit's
forces.
"""

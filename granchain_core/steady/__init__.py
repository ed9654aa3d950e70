"""Steady states: criteria of the regime, Lyapunov exponent, Poincaré section, errors of an orbit's forces."""

"""Steady states: regime criteria, Lyapunov exponent, Poincaré section, and errors of an orbit's forces."""

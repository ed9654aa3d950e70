"""Multipliers, modes, Poincaré section."""

"""The page of stability: multipliers, modes, Poincaré section."""

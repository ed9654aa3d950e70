"""What a disturbance does: multipliers, modes, Poincaré section."""

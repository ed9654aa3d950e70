"""The equation of motion."""

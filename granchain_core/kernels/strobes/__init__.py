"""Decisions on states a period apart: is the motion periodic, and where does it go."""

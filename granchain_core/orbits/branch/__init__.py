"""Branches of periodic orbits along a knob, and the special points on them."""

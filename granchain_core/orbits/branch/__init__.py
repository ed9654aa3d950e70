"""Branches: the continuation of periodic orbits over a knob, special points and their normal forms."""

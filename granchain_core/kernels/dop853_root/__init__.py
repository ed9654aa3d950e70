"""Dormand and Prince's method of order 8 along a short chain, in a transformed time next to contact events."""

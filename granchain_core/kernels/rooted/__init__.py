"""Dormand and Prince's method of order 8 along a short chain, next to contact events in the root of an overlap."""

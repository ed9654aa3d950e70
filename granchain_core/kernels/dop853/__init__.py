"""Dormand and Prince's method of order 8 with contact events located."""

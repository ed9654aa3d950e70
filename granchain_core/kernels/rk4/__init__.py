"""Runge–Kutta of order 4 with a fixed step, split at contact events: scalar, chain in a register, long chain."""

"""Kernels compiled ahead of time, piece by piece (`granchain warm`)."""

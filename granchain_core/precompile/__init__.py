"""Compilation of kernels ahead of time, in pieces (`granchain warm`)."""

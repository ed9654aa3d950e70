"""Kernels compiled ahead of time: which there are, and in which pieces (`granchain warm`)."""

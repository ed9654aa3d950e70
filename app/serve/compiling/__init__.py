"""Kernels are compiled ahead of time, in processes of their own."""

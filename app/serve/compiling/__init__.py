"""Compiles kernels ahead of time, in separate processes."""

"""Compiling kernels, caching them on disk and calling them."""
